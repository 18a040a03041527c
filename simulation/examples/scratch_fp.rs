//! scratch
use hodograph_simulation::contact_problem::*;
use nalgebra::*;
use std::time::Instant;
fn main() {
    for path in std::env::args().skip(1) {
        let v: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let k = v["contacts"].as_u64().unwrap() as usize;
        let mu: Vec<f64> = v["mu"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let q = DVector::from_iterator(3 * k, v["q"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()));
        let mut w = DMatrix::zeros(3 * k, 3 * k);
        for b in v["w"].as_array().unwrap() {
            let (i, j) = (b[0].as_u64().unwrap() as usize, b[1].as_u64().unwrap() as usize);
            for r in 0..3 { for c in 0..3 { w[(3 * i + r, 3 * j + c)] = b[2][3 * r + c].as_f64().unwrap(); } }
        }
        let slip = vec![None; k];
        let p = Problem { w: &w, beta: &q, mu: &mu, slip: &slip, noise: None };
        let t = Instant::now();
        let s = solve(&p, None);
        let t = t.elapsed().as_secs_f64();
        match s {
            Ok(s) => {
                let mut worst = 0.0_f64;
                for i in 0..k {
                    let b: Matrix3<f64> = w.fixed_view::<3, 3>(3 * i, 3 * i).into();
                    let rho = 1.0 / ((b + b.transpose()) * 0.5).symmetric_eigenvalues().max();
                    let r: Vector3<f64> = s.force.fixed_rows::<3>(3 * i).into();
                    let v: Vector3<f64> = s.acceleration.fixed_rows::<3>(3 * i).into();
                    let vt = v.y.hypot(v.z);
                    let z = r - rho * (v + Vector3::new(mu[i] * vt, 0.0, 0.0));
                    let zt = z.y.hypot(z.z);
                    let pz = if zt <= mu[i] * z.x { z } else if mu[i] * zt <= -z.x { Vector3::zeros() } else {
                        let l = (z.x + mu[i] * zt) / (1.0 + mu[i] * mu[i]);
                        Vector3::new(l, mu[i] * l * z.y / zt, mu[i] * l * z.z / zt) };
                    worst = worst.max((r - pz).norm() / rho);
                }
                let vmax = q.amax();
                let count = |n: &str| s.modes.iter().filter(|m| m.name() == n).count();
                println!("{path} {k}: {t:.3} s certificate {:.1e} natural {:.1e} stick {} slide {} separate {}", s.certificate.greatest(), worst / vmax, count("stick"), count("slide"), count("separate"));
            }
            Err(e) => println!("{path} {k}: {t:.3} s {e}"),
        }
    }
}
