//! Sketches of mechanisms: those of the gallery are what the models give.

use crate::common::{hodograph, root};

fn sketch(model: &str, more: &[&str]) -> String {
    let run = hodograph(&[&["plot", "--sketch", model], more].concat(), "");
    assert_eq!(run.code, 0, "{model}: {}", run.stderr);
    run.stdout
}

/// `HODOGRAPH_UPDATE=1 cargo test -p hodograph-cli --test all sketches::` draws them anew.
#[test]
fn sketches_of_the_gallery_are_those_of_the_models() {
    let gallery = std::fs::read_to_string(root().join("docs/gallery.md")).unwrap();
    let models = std::fs::read_dir(root().join("models/shapes")).unwrap().map(|entry| entry.unwrap().path());
    let mut count = 0;
    for model in models.filter(|path| path.extension().is_some_and(|ending| ending == "mech")) {
        let name = model.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(
            gallery.contains(&format!("gallery/shapes/{name}.svg")),
            "docs/gallery.md does not show {name}"
        );
        let picture = root().join(format!("docs/gallery/shapes/{name}.svg"));
        let drawn = sketch(&model.display().to_string(), &[]);
        if crate::expectations::are_written_anew() {
            std::fs::write(&picture, &drawn).unwrap();
        }
        let kept = std::fs::read_to_string(&picture).unwrap_or_default();
        assert!(
            kept == drawn,
            "{name}: run `HODOGRAPH_UPDATE=1 cargo test -p hodograph-cli --test all sketches::`"
        );
        count += 1;
    }
    assert!(count >= 7, "{count}");
}

/// The middle of a circle of the picture that is that of a point.
fn dots(picture: &str) -> Vec<[f64; 2]> {
    let number = |text: &str, name: &str| -> f64 {
        let (_, rest) = text.split_once(&format!("{name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    picture
        .lines()
        .filter(|line| line.starts_with("<circle"))
        .map(|line| ["cx", "cy"].map(|name| number(line, name)))
        .collect()
}

/// A mechanism in a plane is drawn from the side: distances of points are those of the model times one scale.
#[test]
fn a_sketch_is_to_scale() {
    let model = root().join("models/planar_double_pendulum.mech").display().to_string();
    let picture = sketch(&model, &["--state", "{\"q\": {\"q1\": 0, \"q2\": 0}}"]);
    let hanging = dots(&picture);
    assert!(
        hanging.len() > 2 && hanging.iter().all(|dot| (dot[0] - hanging[0][0]).abs() < 0.011),
        "{hanging:?}"
    );
    let picture =
        sketch(&model, &["--state", "{\"q\": {\"q1\": 1.5707963267948966, \"q2\": 1.5707963267948966}}"]);
    let lying = dots(&picture);
    assert!(lying.iter().all(|dot| (dot[1] - lying[0][1]).abs() < 0.011), "{lying:?}");
    let span = |dots: &[[f64; 2]], i: usize| {
        dots.iter().map(|dot| dot[i]).fold(f64::NEG_INFINITY, f64::max)
            - dots.iter().map(|dot| dot[i]).fold(f64::INFINITY, f64::min)
    };
    // the picture is 480 by 360 with 24 at its border
    assert!((span(&hanging, 1) - 312.0).abs() < 0.02 && (span(&lying, 0) - 432.0).abs() < 0.02);
}

#[test]
fn a_sketch_is_of_a_model_and_of_nothing_else() {
    let model = root().join("models/shapes/dropped_crate.mech").display().to_string();
    for arguments in
        [&["plot", "--sketch"][..], &["plot", "--sketch", &model, "--mu", "0.5"], &["plot", &model]]
    {
        assert_eq!(hodograph(arguments, "").code, 2, "{arguments:?}");
    }
    let over = hodograph(&["plot", "--sketch", &model, "--output", &model, "--format", "svg"], "");
    assert_eq!(over.code, 2, "{}", over.stderr);
}
