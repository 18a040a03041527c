//! The font of figures: DejaVu Sans, compiled in, so that a figure looks the same on every machine.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::label::{Kind, Label};

/// The font families in an SVG: the font itself, then fonts of the same widths.
pub const FAMILY: &str = "DejaVu Sans, Verdana, Bitstream Vera Sans, Geneva, sans-serif";
/// The size of indices and exponents relative to that of the text.
pub const SMALL: f64 = 0.72;
/// The drop of an index below the base line, in units of the font size.
pub const LOWER: f64 = 0.22;
/// The rise of an exponent above the base line, in the same units.
pub const RAISE: f64 = 0.36;
/// Height of a capital letter, in sizes of the text.
pub const CAPITAL: f64 = 0.729;

static FACES: LazyLock<Option<[Face<'static>; 2]>> = LazyLock::new(|| {
    let face = |data: &'static [u8]| Face::parse(data, 0).ok();
    Some([face(dejavu::sans::regular())?, face(dejavu::sans::oblique())?])
});

fn face(kind: Kind) -> Option<&'static Face<'static>> {
    let [upright, italic] = FACES.as_ref()?;
    Some(if kind == Kind::Symbol { italic } else { upright })
}

/// A glyph of a label: its place on the base line, its rise, and its size.
pub struct Letter {
    kind: Kind,
    glyph: GlyphId,
    /// from the beginning of the label
    pub x: f64,
    /// above the line
    pub raised: f64,
    /// of the font
    pub size: f64,
}

impl Letter {
    /// Draws the outline in units of the font, y upwards, and returns the number of units per font size.
    pub fn outline(&self, builder: &mut dyn OutlineBuilder) -> f64 {
        let Some(face) = face(self.kind) else { return 1.0 };
        face.outline_glyph(self.glyph, builder);
        f64::from(face.units_per_em())
    }
}

/// The glyphs of marked text of a given font size, and its width.
pub fn placed(marked: &str, size: f64) -> (Vec<Letter>, f64) {
    let mut x = 0.0;
    let mut letters = Vec::new();
    for (kind, text) in Label::pieces(marked) {
        let Some(face) = face(kind) else { continue };
        let (scale, raised) = match kind {
            Kind::Word | Kind::Symbol => (1.0, 0.0),
            Kind::Index => (SMALL, -LOWER * size),
            Kind::Exponent => (SMALL, RAISE * size),
        };
        let size = scale * size;
        for letter in text.chars() {
            let glyph = face.glyph_index(letter).unwrap_or(GlyphId(0));
            letters.push(Letter { kind, glyph, x, raised, size });
            let advance = f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
            x += size * advance / f64::from(face.units_per_em());
        }
    }
    (letters, x)
}

/// The width of marked text.
pub fn width(marked: &str, size: f64) -> f64 {
    placed(marked, size).1
}
