//! Tests of the layout and the files of figures.

use super::canvas::{Shape, Sheet};
use super::figure::{Axis, Figure, Legend, Mark, Panel, Series, Sign};
use super::file::Format;
use super::label::{Kind, Label};
use super::{layout, series};

fn figure(points: Vec<[f64; 2]>) -> Figure {
    let mut panel = Panel::new(Axis::new(Label::symbol("t", ""), "s"), Axis::new(Label::name("q1"), "rad"));
    panel.series.push(Series::new("motion", 0, points));
    Figure::new("Motion").panel(panel)
}

fn texts(sheet: &Sheet) -> Vec<String> {
    let text = |shape: &Shape| match shape {
        Shape::Text { marked, .. } => Some(Label::pieces(marked).map(|(_, text)| text).collect()),
        _ => None,
    };
    sheet.shapes.iter().filter_map(text).collect()
}

/// The longest curve in the colour of a style.
fn curve(sheet: &Sheet, style: usize) -> Vec<[f64; 2]> {
    let lines = sheet.shapes.iter().filter_map(|shape| match shape {
        Shape::Line { points, colour, .. } if *colour == series::style(style).colour => Some(points.clone()),
        _ => None,
    });
    lines.max_by_key(Vec::len).unwrap_or_default()
}

#[test]
fn labels_keep_symbols_indices_and_powers_apart() {
    let label = Label::name("q12").then(" [").with_power_of_ten(-3).then(" m]");
    let pieces: Vec<_> = Label::pieces(label.marked()).collect();
    let expected = [
        (Kind::Symbol, "q"),
        (Kind::Index, "12"),
        (Kind::Word, " ["),
        (Kind::Word, "10"),
        (Kind::Exponent, "\u{2212}3"),
        (Kind::Word, " m]"),
    ];
    assert_eq!(pieces, expected);
    assert_eq!(label.plain(), "q_12 [10^\u{2212}3 m]");
    // Characters that mark symbols are removed from words.
    assert_eq!(Label::words("a\u{e001}b\nc").marked(), Label::words("abc").marked());
}

/// A parabola in the data is a parabola on the sheet: its second differences are constant to a few hundredths
/// of a pixel.
#[test]
fn curves_keep_their_form_to_hundredths_of_a_pixel() {
    let figure = figure((0..=40).map(|i| f64::from(i) / 40.0).map(|t| [t, t * t]).collect());
    let places = curve(&layout::draw(&figure).unwrap(), 0);
    assert_eq!(places.len(), 41);
    let second: Vec<f64> = places.windows(3).map(|p| p[0][1] - 2.0 * p[1][1] + p[2][1]).collect();
    assert!(second.iter().all(|d| (d - second[0]).abs() < 1e-6), "{second:?}");
    // The same from the written file.
    let svg = String::from_utf8(figure.bytes(Format::Svg).unwrap()).unwrap();
    let path = svg
        .split(" d=\"")
        .map(|part| part.split('"').next().unwrap_or(""))
        .max_by_key(|path| path.len())
        .unwrap();
    let numbers: Vec<f64> = path
        .split(['M', 'L', ' '])
        .filter(|number| !number.is_empty())
        .map(|number| number.parse().unwrap())
        .collect();
    for (place, written) in places.iter().zip(numbers.chunks(2)) {
        assert!((0..2).all(|axis| (place[axis] - written[axis]).abs() <= 0.00501), "{place:?} {written:?}");
    }
}

/// The grid lines belong to the same scale as the curve: a mark at a tick lies on its grid line.
#[test]
fn marks_lie_on_the_grid_lines_of_their_numbers() {
    let mut figure = figure(vec![[0.0, -1.0], [2.0, 1.0]]);
    figure.panels[0].marks.push(Mark {
        label: "here".into(),
        sign: Sign::Dot,
        style: Some(1),
        at: [1.0, 0.5],
    });
    let sheet = layout::draw(&figure).unwrap();
    let centre = sheet.shapes.iter().find_map(|shape| match shape {
        Shape::Circle { centre, .. } => Some(*centre),
        _ => None,
    });
    let [x, y] = centre.unwrap();
    // Lines of the grid have two ends; one passes vertically through the mark, one horizontally.
    let through = |axis: usize, at: f64| {
        sheet.shapes.iter().any(|shape| match shape {
            Shape::Line { points, .. } => {
                points.len() == 2 && points.iter().all(|point| (point[axis] - at).abs() < 0.02)
            }
            _ => false,
        })
    };
    assert!(through(0, x) && through(1, y), "{x} {y}");
    assert!(texts(&sheet).contains(&"0.5".to_owned()), "{:?}", texts(&sheet));
}

#[test]
fn equal_axes_keep_a_circle_round() {
    let circle = |i: i32| [3.0 * f64::from(i).to_radians().cos(), 3.0 * f64::from(i).to_radians().sin()];
    let mut figure = figure((0..=360).map(circle).collect());
    figure.panels[0].equal = true;
    let places = curve(&layout::draw(&figure).unwrap(), 0);
    let middle = [0, 1].map(|axis| (places[0][axis] + places[180][axis]) / 2.0);
    let radii = places.iter().map(|place| (place[0] - middle[0]).hypot(place[1] - middle[1]));
    let (low, high) = radii.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    assert!(high - low < 1e-6 * high && high > 20.0, "{low} {high}");
}

#[test]
fn numbers_at_axes_are_right_and_never_minus_zero() {
    for (low, high) in [(-1.0, 1.0), (-0.3, 0.07), (0.0, 2.5), (-12345.0, 3.0), (1e-9, 3e-9), (99.99, 100.01)]
    {
        let sheet = layout::draw(&figure(vec![[low, low], [high, high]])).unwrap();
        let numbers: Vec<String> = texts(&sheet)
            .into_iter()
            .filter(|text| text.replace('\u{2212}', "-").parse::<f64>().is_ok())
            .collect();
        assert!(numbers.len() > 4, "{numbers:?}");
        assert!(numbers.iter().all(|text| !text.trim_start_matches(['\u{2212}', '0', '.']).is_empty()
            || !text.starts_with('\u{2212}')));
        // Each axis has different numbers, at even steps.
        let values: Vec<f64> =
            numbers.iter().map(|text| text.replace('\u{2212}', "-").parse().unwrap()).collect();
        let rising = values.windows(2).filter(|pair| pair[0] < pair[1]).count();
        assert_eq!(rising, values.len() - 2, "{numbers:?} for {low} .. {high}");
    }
}

#[test]
fn no_data_can_spoil_a_figure() {
    let sets: [&[[f64; 2]]; 8] = [
        &[],
        &[[f64::NAN, 1.0], [f64::INFINITY, f64::NEG_INFINITY]],
        &[[0.0, 0.0]],
        &[[1.0, 5e-324], [2.0, 0.0]],
        &[[-1.7e308, 1.7e308], [1.7e308, -1.7e308]],
        &[[1.0, 1.0 + f64::EPSILON], [2.0, 1.0]],
        &[[0.0, 1e-300], [1e-300, 3e-300], [f64::NAN, 0.0], [1e-300, 2e-300]],
        &[[1e15, 1e15], [1e15 + 1.0, 1e15 + 2.0]],
    ];
    for points in sets {
        for equal in [false, true] {
            let mut figure = figure(points.to_vec());
            figure.panels[0].equal = equal;
            let svg = String::from_utf8(figure.bytes(Format::Svg).unwrap()).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{points:?}\n{svg}");
            roxmltree::Document::parse(&svg).expect("SVG is XML");
            figure.bytes(Format::Png).unwrap();
        }
    }
}

#[test]
fn pictures_show_what_the_sheet_has() {
    let mut figure = figure(vec![[0.0, 0.0], [1.0, 1.0]]);
    figure.panels[0].marks.push(Mark {
        label: "end".into(),
        sign: Sign::Dot,
        style: Some(1),
        at: [0.5, 0.2],
    });
    figure.legend = Legend::Below;
    let sheet = layout::draw(&figure).unwrap();
    let picture = tiny_skia::Pixmap::decode_png(&figure.bytes(Format::Png).unwrap()).unwrap();
    assert_eq!([picture.width(), picture.height()], sheet.size.map(|length| (2.0 * length).ceil() as u32));
    for shape in &sheet.shapes {
        let Shape::Circle { centre: [x, y], colour, .. } = shape else { continue };
        let seen = picture.pixel((2.0 * x) as u32, (2.0 * y) as u32).unwrap();
        assert_eq!([seen.red(), seen.green(), seen.blue()], colour.0);
    }
    // The title is drawn: its place is not white.
    let dark = |x: u32, y: u32| picture.pixel(x, y).unwrap().red() < 128;
    let middle = picture.width() / 2;
    assert!((middle - 60..middle + 60).any(|x| (30..64).any(|y| dark(x, y))));
}

/// Eight coordinates are common: all curves of a panel look different.
#[test]
fn curves_look_different() {
    let looks: Vec<_> = (0..36).map(series::style).map(|style| (style.colour, style.dashes)).collect();
    for (index, look) in looks.iter().enumerate() {
        assert!(!looks[..index].contains(look), "{index}: {look:?}");
    }
}
