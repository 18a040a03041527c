//! Lowers colours: a name, or red, green and blue.

use super::super::Lowering;
use crate::diagnostics::{Diagnostic, codes};
use crate::suggest;
use crate::syntax::tree::{ExprKind, Field};

/// The colours that have names, with red, green and blue from 0 to 255.
const NAMED: [(&str, [u8; 3]); 12] = [
    ("black", [32, 32, 32]),
    ("white", [245, 245, 245]),
    ("grey", [136, 136, 136]),
    ("silver", [192, 196, 200]),
    ("red", [200, 54, 46]),
    ("orange", [224, 130, 40]),
    ("yellow", [232, 196, 52]),
    ("green", [62, 142, 80]),
    ("teal", [42, 142, 146]),
    ("blue", [52, 104, 186]),
    ("purple", [126, 84, 160]),
    ("brown", [138, 98, 66]),
];

impl Lowering<'_> {
    /// `colour: red` or `colour: [0.8, 0.2, 0.2]`
    pub(super) fn colour(&mut self, field: &Field) -> Option<[f64; 3]> {
        match &field.value.kind {
            ExprKind::Error => None,
            ExprKind::Name(name) => {
                if let Some((_, colour)) = NAMED.iter().find(|(known, _)| known == name) {
                    return Some(colour.map(|part| f64::from(part) / 255.0));
                }
                let error =
                    Diagnostic::new(codes::SHAPE, field.value.span, format!("there is no colour `{name}`"));
                let names = NAMED.map(|(name, _)| name);
                let meant =
                    if name == "gray" { Some("grey") } else { suggest::nearest(name, names.into_iter()) };
                self.report(match meant {
                    Some(near) => error.did_you_mean(near),
                    None => error.help(format!("there are {}, and `[red, green, blue]`", names.join(", "))),
                });
                None
            }
            ExprKind::List(parts) if parts.len() == 3 => {
                let parts: Vec<Option<f64>> = parts.iter().map(|part| self.constant(part).constant).collect();
                let parts: Vec<f64> = parts.into_iter().collect::<Option<_>>()?;
                if parts.iter().any(|part| !(0.0..=1.0).contains(part)) {
                    let message = "red, green and blue are numbers from 0 to 1";
                    self.error(codes::SHAPE, field.value.span, message);
                    return None;
                }
                parts.try_into().ok()
            }
            _ => {
                let message = "a colour is a name or `[red, green, blue]`";
                let error = Diagnostic::new(codes::SHAPE, field.value.span, message);
                self.report(error.help("write `colour: orange` or `colour: [0.9, 0.5, 0.2]`"));
                None
            }
        }
    }
}
