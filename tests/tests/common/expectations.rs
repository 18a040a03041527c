//! Whether tests write their expectations anew.

/// Whether `HODOGRAPH_UPDATE` asks for it. Where `CI` is set a test that writes what it compares with would hold
/// nothing, so it is refused there.
pub fn are_written_anew() -> bool {
    let is_set = |name| std::env::var_os(name).is_some();
    decide(is_set("HODOGRAPH_UPDATE"), is_set("CI")).unwrap_or_else(|refusal| panic!("{refusal}"))
}

fn decide(asked: bool, in_ci: bool) -> Result<bool, &'static str> {
    if asked && in_ci {
        return Err("HODOGRAPH_UPDATE writes expectations anew, which is refused where CI is set: \
                    run the command by hand, and read what has changed");
    }
    Ok(asked)
}

#[test]
fn they_are_never_written_in_ci() {
    assert_eq!(
        (decide(false, false), decide(true, false), decide(false, true)),
        (Ok(false), Ok(true), Ok(false))
    );
    assert!(decide(true, true).is_err());
}
