//! The JSON schemas of the messages. Viewers know those of Foxglove by their names and fields.

use serde_json::{Map, Value, json};

/// An object with these required properties.
fn object<'a>(title: &str, properties: impl IntoIterator<Item = (&'a str, Value)>) -> Value {
    let properties: Map<String, Value> =
        properties.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    let names: Vec<&String> = properties.keys().collect();
    json!({ "title": title, "type": "object", "required": names, "properties": properties })
}

fn list(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn string() -> Value {
    json!({ "type": "string" })
}

fn boolean() -> Value {
    json!({ "type": "boolean" })
}

fn whole() -> Value {
    json!({ "type": "integer", "minimum": 0 })
}

/// `time` or `duration`.
fn time(title: &str) -> Value {
    let nanoseconds = json!({ "type": "integer", "minimum": 0, "maximum": 999_999_999 });
    object(title, [("sec", whole()), ("nsec", nanoseconds)])
}

fn vector(title: &str) -> Value {
    object(title, ["x", "y", "z"].map(|name| (name, number())))
}

fn quaternion() -> Value {
    object("foxglove.Quaternion", ["x", "y", "z", "w"].map(|name| (name, number())))
}

fn pose() -> Value {
    let place = vector("foxglove.Vector3");
    object("foxglove.Pose", [("position", place), ("orientation", quaternion())])
}

fn color() -> Value {
    object("foxglove.Color", ["r", "g", "b", "a"].map(|name| (name, number())))
}

/// `foxglove.FrameTransforms`.
pub fn transforms() -> Value {
    let transform = object(
        "foxglove.FrameTransform",
        [
            ("timestamp", time("time")),
            ("parent_frame_id", string()),
            ("child_frame_id", string()),
            ("translation", vector("foxglove.Vector3")),
            ("rotation", quaternion()),
        ],
    );
    object("foxglove.FrameTransforms", [("transforms", list(transform))])
}

/// `foxglove.Log`.
pub fn log() -> Value {
    object(
        "foxglove.Log",
        [
            ("timestamp", time("time")),
            ("level", whole()),
            ("message", string()),
            ("name", string()),
            ("file", string()),
            ("line", whole()),
        ],
    )
}

/// `foxglove.SceneUpdate`.
pub fn scene() -> Value {
    // Kinds of shapes that are not used; viewers require their lists, which are empty.
    let none = |title: &str| list(object(title, []));
    let arrow = object(
        "foxglove.ArrowPrimitive",
        [
            ("pose", pose()),
            ("shaft_length", number()),
            ("shaft_diameter", number()),
            ("head_length", number()),
            ("head_diameter", number()),
            ("color", color()),
        ],
    );
    let sphere = object(
        "foxglove.SpherePrimitive",
        [("pose", pose()), ("size", vector("foxglove.Vector3")), ("color", color())],
    );
    let line = object(
        "foxglove.LinePrimitive",
        [
            ("type", whole()),
            ("pose", pose()),
            ("thickness", number()),
            ("scale_invariant", boolean()),
            ("points", list(vector("foxglove.Point3"))),
            ("color", color()),
            ("colors", list(color())),
            ("indices", list(whole())),
        ],
    );
    let text = object(
        "foxglove.TextPrimitive",
        [
            ("pose", pose()),
            ("billboard", boolean()),
            ("font_size", number()),
            ("scale_invariant", boolean()),
            ("color", color()),
            ("text", string()),
        ],
    );
    let entity = object(
        "foxglove.SceneEntity",
        [
            ("timestamp", time("time")),
            ("frame_id", string()),
            ("id", string()),
            ("lifetime", time("duration")),
            ("frame_locked", boolean()),
            ("metadata", none("foxglove.KeyValuePair")),
            ("arrows", list(arrow)),
            ("cubes", none("foxglove.CubePrimitive")),
            ("spheres", list(sphere)),
            ("cylinders", none("foxglove.CylinderPrimitive")),
            ("lines", list(line)),
            ("triangles", none("foxglove.TriangleListPrimitive")),
            ("texts", list(text)),
            ("models", none("foxglove.ModelPrimitive")),
        ],
    );
    object(
        "foxglove.SceneUpdate",
        [("deletions", none("foxglove.SceneEntityDeletion")), ("entities", list(entity))],
    )
}

/// Numbers by name, each with its unit.
pub fn numbers<'a>(curves: impl Iterator<Item = (&'a str, &'a str)>) -> Value {
    let number = |(name, unit): (&'a str, &'a str)| (name, json!({ "type": "number", "description": unit }));
    let mut schema = object("numbers over time", curves.map(number));
    // A number that is unknown at a time is left out there.
    schema["required"] = json!([]);
    schema
}

/// Vectors by name.
pub fn vectors<'a>(names: impl Iterator<Item = &'a str>) -> Value {
    object("forces over time, N along N.x, N.y, N.z", names.map(|name| (name, vector("force"))))
}
