//! Suggests the name nearest to an unknown one.

use hodograph_generator::suggest::distance;

/// The name in `names` most similar to `name`, if it is similar enough to be meant.
pub fn nearest<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = match name.chars().count() {
        0..=2 => 0,
        length => (length / 3).max(1),
    };
    names
        .into_iter()
        .map(|other| (distance(&name.to_lowercase(), &other.to_lowercase()), other))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, other)| other)
}

/// The only name that begins with `name`.
fn completed<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let mut longer = names.into_iter().filter(|other| name.len() > 2 && other.starts_with(name));
    longer.next().filter(|_| longer.next().is_none())
}

/// The end of a message about an unknown name: a similar name if there is one, else the first names that
/// exist.
pub fn hint<'a>(name: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(other) = nearest(name, names.clone()).or_else(|| completed(name, names.clone())) {
        return format!("did you mean `{other}`?");
    }
    let all: Vec<&str> = names.into_iter().collect();
    match all.len() {
        0 => "there are none".to_owned(),
        1..=12 => format!("there are: {}", all.join(", ")),
        more => format!("there are: {}, and {} more", all[..10].join(", "), more - 10),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found() {
        assert_eq!(nearest("gama", ["delta", "gamma"]), Some("gamma"));
        assert_eq!(nearest("BCAC", ["BcAc"]), Some("BcAc"));
        assert_eq!(nearest("q12", ["u1", "q21"]), Some("q21"));
        assert_eq!(nearest("mass", ["l", "k"]), None);
    }
}
