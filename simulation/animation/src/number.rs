//! Numbers as pages and tables write them.

/// A number to six digits, in the shortest form.
pub fn number(value: f64) -> String {
    let rounded = format!("{value:.5e}");
    let exponent = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        None => format!("{value}"),
        _ if value == 0.0 => "0".to_owned(),
        Some(exponent @ -4..=5) => {
            let digits = usize::try_from(5 - exponent).unwrap_or(0);
            shortened(&format!("{value:.digits$}"), "")
        }
        Some(exponent) => match rounded.split_once('e') {
            Some((digits, _)) => shortened(digits, &format!("e{exponent}")),
            None => rounded,
        },
    }
}

/// The digits without trailing zeros after the point, followed by `rest`.
fn shortened(digits: &str, rest: &str) -> String {
    let short = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    match short {
        "-0" => format!("0{rest}"),
        short => format!("{short}{rest}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_right_to_six_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.3"),
            (123456.7, "123457"),
            (1234567.0, "1.23457e6"),
            (1.0 / 3.0, "0.333333"),
            (1e-5, "1e-5"),
            (-1.234567e-9, "-1.23457e-9"),
            (6.02e23, "6.02e23"),
            (1e-300, "1e-300"),
        ] {
            let found = number(value);
            assert_eq!(found, text);
            let read: f64 = found.parse().unwrap();
            assert!((read - value).abs() <= 5.1e-6 * value.abs(), "{value}: {found}");
        }
    }
}
