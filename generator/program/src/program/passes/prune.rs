//! Removes guards of values that no output uses.

use crate::program::derivation::Derived;

/// Removes guards that no output needs.
pub fn prune(derived: &Derived) -> Derived {
    let wanted = derived.outputs.iter().flat_map(|output| output.values.iter().copied());
    let reachable = derived.graph.reachable(wanted);
    let mut pruned = derived.clone();
    pruned.guards.retain(|guard| reachable[guard.value.0 as usize]);
    pruned
}

#[cfg(test)]
mod tests {
    use super::super::lower;
    use super::super::testing::{keeps_the_meaning, small, speeds};
    use super::*;
    use crate::program::output::Guard;

    fn guarded() -> Derived {
        let mut spare = None;
        let mut derived = small(|g| {
            let [a, b, c, _] = speeds(g);
            spare = Some(g.sum([b, c]));
            vec![g.div(a, b), c]
        });
        let guard = |value, message: &str| Guard { value, scale: None, message: message.into() };
        let b = derived.graph.input(crate::program::graph::Input::Speed(1));
        derived.guards = vec![guard(b, "needed"), guard(spare.unwrap(), "spare")];
        derived
    }

    #[test]
    fn guards_of_used_values_stay_and_others_go() {
        let pruned = prune(&guarded());
        let messages: Vec<_> = pruned.guards.iter().map(|guard| guard.message.as_str()).collect();
        assert_eq!(messages, ["needed"]);
    }

    #[test]
    fn outputs_are_left_alone_to_the_last_operation() {
        let (before, after) = (lower(&guarded()), lower(&prune(&guarded())));
        assert_eq!((before.operations, before.outputs), (after.operations, after.outputs));
        keeps_the_meaning(prune);
    }
}
