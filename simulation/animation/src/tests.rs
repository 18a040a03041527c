//! Tests of the animated pages.

use super::*;

#[path = "../../../generator/cli/tests/common/browser.rs"]
mod browser;

/// A double pendulum that is struck twice, with a given number of moments.
fn pendulum(moments: usize) -> Animation {
    let times: Vec<f64> = (0..moments).map(|index| 3.0 * index as f64 / (moments - 1) as f64).collect();
    let [mut first, mut second] = [Vec::new(), Vec::new()];
    for time in &times {
        let (a, b) = (1.2 * (3.0 * time).cos(), 0.9 * (5.0 * time + 1.0).cos());
        first.push([a.sin(), -a.cos(), 0.0]);
        second.push([a.sin() + (a + b).sin(), -a.cos() - (a + b).cos(), 0.0]);
    }
    let point = |name: &str, places| Point { name: name.to_owned(), places, quiet: false };
    let series = |panel: &str, name: &str, unit: &str, of: fn(f64) -> f64| Series {
        panel: panel.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        values: times.iter().map(|&time| of(time)).collect(),
    };
    let event = |index: usize| Happening {
        time: times[index],
        contact: "tip_wall".to_owned(),
        label: "collision".to_owned(),
        at: Some(second[index]),
        impulse: Some([-1.0, 0.3, 0.0]),
    };
    Animation {
        title: "Double pendulum".to_owned(),
        points: vec![
            point("O", vec![[0.0; 3]; moments]),
            point("Elbow", first.clone()),
            point("Tip", second.clone()),
            point("Tip_again", second.clone()),
        ],
        frames: vec![Frame {
            name: "B".to_owned(),
            at: 1,
            axes: vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; moments],
        }],
        segments: segments(&[None, Some(0), Some(1), Some(2)], &[(1, vec![0, 1, 2])]),
        events: vec![event(moments / 3), event(2 * moments / 3)],
        forces: vec![Force {
            name: "tip_wall".to_owned(),
            at: second.clone(),
            force: (0..moments).map(|index| (5 * index > 4 * moments).then_some([0.0, 2.0, 0.0])).collect(),
        }],
        series: vec![
            series("energy", "kinetic", "J", |time| 2.0 + (3.0 * time).sin()),
            series("energy", "potential", "J", |time| -(3.0 * time).sin()),
            series("gap", "tip_wall", "m", |time| {
                if time > 1.0 && time < 1.1 { f64::NAN } else { 1e-7 * time.cos() }
            }),
        ],
        up: [0.0, 1.0, 0.0],
        times,
        ..Animation::default()
    }
}

/// The data of a page.
fn data(page: &str) -> serde_json::Value {
    let text = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(text).unwrap()
}

#[test]
fn lines_connect_points_with_those_they_are_defined_by_and_with_their_bodies() {
    let lines = segments(&[None, Some(0), Some(1), Some(1), None], &[(1, vec![0, 2, 1, 4]), (4, vec![9])]);
    assert_eq!(lines, [[0, 1], [1, 2], [1, 3], [1, 4]]);
}

#[test]
fn pages_hold_everything_and_load_nothing() {
    let page = page(&pendulum(100));
    for network in ["http:", "https:", "src=", "url(", "@import", "<link"] {
        assert!(!page.contains(network), "{network}");
    }
    let data = data(&page);
    assert_eq!(data["points"][2]["name"], "Tip");
    assert_eq!(data["points"][2]["places"].as_array().unwrap().len(), 100);
    // NaN is a gap in the curve.
    assert!(data["series"][2]["values"].as_array().unwrap().iter().any(|value| value.is_null()));
}

#[test]
fn names_cannot_end_the_data_or_the_title() {
    let mut animation = pendulum(10);
    animation.title = "</title><script>alert(1)</script>".to_owned();
    animation.points[0].name = "</script><b>".to_owned();
    let page = page(&animation);
    assert_eq!(page.matches("</script>").count(), 2);
    assert_eq!(page.matches("</title>").count(), 1);
    assert_eq!(data(&page)["points"][0]["name"], "</script><b>");
}

#[test]
fn long_motions_are_thinned_but_for_their_events() {
    let animation = pendulum(50_000);
    let data = data(&page(&animation));
    let times: Vec<f64> =
        data["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    assert!(times.len() > MOMENTS / 2 && times.len() <= MOMENTS + 4, "{}", times.len());
    assert_eq!(times.last(), animation.times.last());
    assert!(animation.events.iter().all(|event| times.contains(&event.time)));
    for list in ["/points/0/places", "/frames/0/axes", "/forces/0/at", "/forces/0/force", "/series/0/values"]
    {
        assert_eq!(data.pointer(list).unwrap().as_array().unwrap().len(), times.len(), "{list}");
    }
}

/// Time runs, the tip moves as in the data, keys and buttons work, and no two names overlap.
const MOTION: &str = r#"
const data = JSON.parse(document.getElementById('data').textContent);
const text = (id) => document.getElementById(id).textContent;
const tip = () => { const node = document.querySelectorAll('#stage .point')[2]; return [Number(node.getAttribute('cx')), Number(node.getAttribute('cy'))]; };
const play = document.getElementById('play'), slider = document.getElementById('time');
const key = (name, more) => document.body.dispatchEvent(new page.KeyboardEvent('keydown', { key: name, bubbles: true, ...more }));
const overlaps = (when) => {
  const names = [...document.querySelectorAll('svg text')].filter((node) => node.style.display !== 'none' && node.textContent && box(node).width);
  names.forEach((a, index) => names.slice(index + 1).forEach((b) => {
    if (crossing(box(a), box(b), 1)) complain(`${when}: ${describe(a)} on ${describe(b)}`);
  }));
};
if (play.getAttribute('aria-label') !== 'Pause') complain('does not begin to run');
const before = [text('now'), ...tip()];
await wait(500);
const after = [text('now'), ...tip()];
if (before[0] === after[0] || Math.hypot(before[1] - after[1], before[2] - after[2]) < 1) complain(`does not move: ${before} ${after}`);
overlaps('running');
key(' ');
const still = text('now');
await wait(200);
if (text('now') !== still || play.getAttribute('aria-label') !== 'Play') complain('does not pause');
key('Home');
const start = tip();
const is = (time) => Math.abs(Number(slider.value) - time) < 1e-9;
if (!is(data.times[0])) complain('Home does not lead to the start');
key('ArrowRight');
if (!is(data.times[1])) complain(`a step leads to ${slider.value}`);
key('ArrowLeft');
key('End');
if (!is(data.times[data.times.length - 1])) complain('End does not lead to the end');
if (![...document.querySelectorAll('.force')].some((node) => node.style.display !== 'none' && node.getAttribute('d'))) complain('no force at the end');
overlaps('at the end');
// The picture keeps the form of the motion: distances on the stage are those of the data times one number.
const scale = [];
for (const index of [10, 40, 90]) {
  slider.value = data.times[index];
  slider.dispatchEvent(new page.Event('input'));
  const at = tip(), a = data.points[2].places[index], b = data.points[2].places[0];
  scale.push(Math.hypot(at[0] - start[0], at[1] - start[1]) / Math.hypot(a[0] - b[0], a[1] - b[1]));
}
if (Math.max(...scale) - Math.min(...scale) > 0.01 * scale[0]) complain(`the picture is not to scale: ${scale}`);
const buttons = [...document.querySelectorAll('#events button')];
if (buttons.length !== data.events.length) complain('events are missing');
buttons[0].click();
if (!is(data.events[0].time)) complain('an event does not lead to its time');
if (![...document.querySelectorAll('.arrow.impulse')].some((node) => node.closest('#stage') && node.style.display !== 'none')) complain('no impulse at the event');
const seen = tip();
for (let times = 0; times < 5; times++) key('ArrowLeft', { shiftKey: true });
if (Math.hypot(tip()[0] - seen[0], tip()[1] - seen[1]) < 0.5) complain('the view does not turn');
document.getElementById('view').click();
if (Math.hypot(tip()[0] - seen[0], tip()[1] - seen[1]) > 0.01) complain('the view does not come back');
const charts = [...document.querySelectorAll('.chart')];
if (charts.length !== 2 || charts.some((chart) => !chart.querySelector('.curve'))) complain('curves are missing');
// Curves begin and end where the lines behind them do: both have one axis of time.
for (const chart of charts) {
  const line = box(chart.querySelector('line.grid, line.axis')), curves = [...chart.querySelectorAll('.curve')].map(box);
  const off = [Math.min(...curves.map((c) => c.left)) - line.left, Math.max(...curves.map((c) => c.right)) - line.right];
  if (off.some((o) => !(Math.abs(o) < 2))) complain(`curves are off their axis of time by ${off}`);
}
// Events are marked on the slider and in the curves, time runs as slowly as 0.01, and the curves show less of it.
if (document.querySelectorAll('#marks .mark').length !== data.events.length) complain('events are not marked on the slider');
if (charts.some((chart) => chart.querySelectorAll('.mark').length !== data.events.length)) complain('events are not marked in the curves');
if (![...document.querySelectorAll('#speed option')].some((option) => Number(option.value) <= 0.01)) complain('no slow motion');
const numbers = () => [...charts[0].querySelectorAll('.number')].map((node) => node.textContent).join(' ');
const all = numbers();
document.getElementById('closer').click();
if (numbers() === all) complain('the curves do not zoom in time');
document.getElementById('whole').click();
if (numbers() !== all) complain('the curves do not show all the time again');
for (const node of document.querySelectorAll('button, select, input[type=range]')) if (box(node).height < 36) complain(`too small for a finger: ${describe(node)}`);
return found;
"#;

#[test]
#[ignore = "needs Chromium"]
fn mechanisms_move_in_a_browser() {
    let complaints = browser::complaints(&page(&pendulum(100)), MOTION);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// If a motion in the plane of N.x and N.y is viewed from above, N.x points to the right and N.y upwards.
const UPRIGHT: &str = r#"
const data = JSON.parse(document.getElementById('data').textContent);
const slider = document.getElementById('time');
const at = (index) => {
  slider.value = data.times[index];
  slider.dispatchEvent(new page.Event('input'));
  const node = document.querySelectorAll('#stage .point')[2];
  return [Number(node.getAttribute('cx')), Number(node.getAttribute('cy'))];
};
for (const index of [10, 25, 40, 90]) {
  const [a, b] = [data.points[2].places[index], data.points[2].places[0]], [p, q] = [at(index), at(0)];
  if ((a[0] - b[0]) * (p[0] - q[0]) < 0) complain('N.x points to the left');
  if ((a[1] - b[1]) * (p[1] - q[1]) > 0) complain('N.y points down');
}
return found;
"#;

#[test]
#[ignore = "needs Chromium"]
fn planes_are_seen_upright_in_a_browser() {
    for up in [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]] {
        let page = page(&Animation { up, ..pendulum(100) });
        let complaints = browser::complaints(&page, UPRIGHT);
        assert!(complaints.is_empty(), "{up:?}: {}", complaints.join("\n"));
    }
}

/// The texts of the model are in the page, and cannot end the elements that contain them.
#[test]
fn pages_describe_the_model_of_their_motion() {
    let setup = Setup {
        surfaces: vec![("tip".to_owned(), 0.3, 0.7, "stronge".to_owned())],
        parameters: vec![Value {
            name: "m".to_owned(),
            value: 2.5,
            unit: "kg".to_owned(),
            docs: "</table><script>".to_owned(),
        }],
        model: "mechanism A;\n// </pre><script>alert(1)</script>\n".to_owned(),
        ..Setup::default()
    };
    let page = page(&Animation { setup, ..pendulum(10) });
    for part in ["tip: \u{3bc} = 0.3, e = 0.7, stronge", "<td>kg</td>", "mechanism A;\n//"] {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("<script").count(), 2);
}
