//! How the cost of a chain grows with its length.

use plotters::prelude::*;

use crate::cases::Origin;
use crate::harness::ROUTINES;
use crate::peers::Peers;
use crate::table::Row;
use crate::tools::{Failure, Folders};

/// Draws instructions over links for the chains, parameters fixed, with the best peer's figures as circles.
pub fn chains(folders: &Folders, rows: &[Row<'_>], peers: &Peers) -> Result<(), Failure> {
    let chain =
        |row: &&Row<'_>| matches!(row.derivation.case.origin, Origin::Chain(_)) && row.derivation.fixed;
    let rows: Vec<&Row<'_>> = rows.iter().filter(chain).collect();
    if rows.len() < 2 {
        return Ok(());
    }
    let path = folders.work.join("chains.svg");
    draw(&path.display().to_string(), &rows, peers).map_err(|error| Failure::new(error.to_string()))?;
    println!("\nCost of chains: {}", path.display());
    Ok(())
}

fn links(row: &Row<'_>) -> f64 {
    match row.derivation.case.origin {
        Origin::Chain(links) => links as f64,
        _ => 0.0,
    }
}

fn draw(path: &str, rows: &[&Row<'_>], peers: &Peers) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(path, (720, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .caption(
            "Instructions per evaluation, chain of n links on a cart (circles: best peer)",
            ("sans-serif", 18),
        )
        .x_label_area_size(36)
        .y_label_area_size(64)
        .build_cartesian_2d((0.9f64..50.0).log_scale(), (20.0f64..50_000.0).log_scale())?;
    chart.configure_mesh().x_desc("links").y_desc("instructions").draw()?;
    let colours = [RGBColor(0, 98, 155), RGBColor(196, 78, 0), RGBColor(0, 122, 61), RGBColor(120, 60, 140)];
    for ((routine, _), colour) in ROUTINES.iter().zip(colours) {
        let points: Vec<(f64, f64)> =
            rows.iter().filter_map(|row| Some((links(row), *row.counts.get(routine)?))).collect();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3))?
            .label(*routine)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
        let theirs = [(5.0, "cart5"), (20.0, "chain20")]
            .into_iter()
            .filter_map(|(links, name)| Some((links, peers.best(name, routine)?.instructions)));
        chart.draw_series(theirs.map(|point| Circle::new(point, 5, colour.stroke_width(1))))?;
    }
    chart.configure_series_labels().background_style(WHITE).border_style(BLACK).draw()?;
    area.present()?;
    Ok(())
}
