//! SDF worlds that are refused, and what is said.

use headway_sim::files::{SdfSpec, parse_sdf};

use crate::common::{cylinder, document, model};

fn refusal(bytes: &[u8]) -> String {
    parse_sdf(bytes, &SdfSpec::default()).unwrap_err().to_string()
}

fn geometry(geometry: &str) -> String {
    document(&model("m", "0 0 0 0 0 0", geometry))
}

fn polyline(points: &[&str]) -> String {
    let points: String = points.iter().map(|point| format!("<point>{point}</point>")).collect();
    geometry(&format!("<polyline><height>1</height>{points}</polyline>"))
}

fn posed(pose: &str) -> String {
    document(&model("m", "", &cylinder(1.0, 1.0)).replace("<pose></pose>", pose))
}

/// The place of what [`geometry`] makes.
const PLACE: &str = "line 1, model 'm', link 'link', collision 'collision': ";

/// Checks that each text is refused in words that hold what is beside it.
fn assert_refused(cases: Vec<(String, String)>) {
    for (text, wanted) in cases {
        let error = refusal(text.as_bytes());
        assert!(error.contains(&wanted), "{error}\n  wanted: {wanted}");
        assert!(error.len() < 600, "{error}");
    }
}

#[test]
fn faults_of_documents_are_named() {
    assert_refused(vec![
        (String::new(), "no well-formed XML: the document does not have a root node".into()),
        ("<sdf version='1.6'><world".into(), "no well-formed XML: ".into()),
        ("<sdf version='1.6'><world></sdf>".into(), "expected 'world' tag, not 'sdf' at 1:27".into()),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><sdf/>".into(), "a document type (DTD) is not allowed".into()),
        ("<sdf version='1.6'>&lol;</sdf>".into(), "unknown entity reference 'lol'".into()),
        ("<robot/>".into(), "line 1: root = 'robot': must be <sdf>, the root of an SDF document".into()),
        ("<sdf><world/></sdf>".into(), "line 1: version = '': must be from 1.4 to 1.12".into()),
        ("<sdf version='2.0'><world/></sdf>".into(), "version = '2.0': must be from 1.4 to 1.12".into()),
        ("<sdf version='1.6'/>".into(), "line 1: <world> is missing".into()),
        (
            "<sdf version='1.6'>\n<world/>\n<world/>\n<world/></sdf>".into(),
            "line 3: world = 3 worlds: must be one world in a file".into(),
        ),
    ]);
}

#[test]
fn faults_of_shapes_are_named() {
    assert_refused(vec![
        (geometry(""), "<a shape of the geometry> is missing".into()),
        (geometry("").replace("<geometry></geometry>", ""), format!("{PLACE}<geometry> is missing")),
        (geometry("<cylinder><radius>1</radius></cylinder>"), format!("{PLACE}<length> is missing")),
        (geometry(&cylinder(0.0, 1.0)), format!("{PLACE}radius = 0: must be from 0.000001 to 1000000")),
        (geometry(&cylinder(-0.5, 1.0)), format!("{PLACE}radius = -0.5: must be from")),
        (geometry(&cylinder(f64::NAN, 1.0)), format!("{PLACE}radius = NaN: must be from")),
        (
            geometry("<sphere><radius>1e300</radius></sphere>"),
            format!("radius = 1{}: must be from -10000000 to 10000000", "0".repeat(300)),
        ),
        (
            geometry("<sphere><radius>2e6</radius></sphere>"),
            "radius = 2000000: must be from 0.000001 to 1000000".into(),
        ),
        (geometry("<sphere><radius>wide</radius></sphere>"), format!("{PLACE}radius = 'wide': must be a number")),
        (geometry("<box><size>1 2</size></box>"), format!("{PLACE}size = 2 numbers: must be 3 numbers")),
        (geometry("<box><size>1 2 inf</size></box>"), format!("{PLACE}size = inf: must be from")),
        (geometry("<plane><normal>0 0 0</normal></plane>"), "normal = 0 0 0: must be a direction, other than 0".into()),
        (polyline(&["0 0", "1 0"]), format!("{PLACE}polyline = 2 points: must be three different points or more")),
        (
            polyline(&["0 0", "1 1", "1 0", "0 1"]),
            format!("{PLACE}polyline = 4 points: must be an outline that does not meet itself"),
        ),
        (polyline(&["0 0 0", "1 1", "1 0"]), "point = 3 numbers: must be 2 numbers".into()),
        (polyline(&vec!["0 0"; 501]), "polyline = more than 500 points: must be at most 500 points".into()),
        // Of two, the first was once read and the second passed over.
        (
            geometry("<sphere><radius>1</radius></sphere><box><size>1 2 3</size></box>"),
            format!("{PLACE}geometry = 'sphere' and 'box': must be one shape"),
        ),
        (geometry("<empty/><mesh/>"), format!("{PLACE}geometry = 'empty' and 'mesh': must be one shape")),
        (geometry("<polyline/><polyline/><box/>"), "geometry = 'polyline' and 'box': must be one shape".into()),
        (
            geometry("<sphere><radius>1</radius><radius>2</radius></sphere>"),
            format!("{PLACE}radius = a second one: must be once in its element"),
        ),
        (
            posed("<pose>0 0 0 0 0 0</pose><pose>1 0 0 0 0 0</pose>"),
            "line 1, model 'm': pose = a second one: must be once in its element".into(),
        ),
    ]);
}

#[test]
fn faults_of_poses_and_names_are_named() {
    let ground = model("m", "0 0 0 0 0 0", &cylinder(1.0, 1.0));
    let triangle = "<polyline><height>1</height><point>0 0</point><point>1 0</point><point>0 1</point></polyline>";
    assert_refused(vec![
        (posed("<pose>0 0 0</pose>"), "line 1, model 'm': pose = 3 numbers: must be 6 numbers".into()),
        (posed("<pose>0 0 x 0 0 0</pose>"), "line 1, model 'm': pose = 'x': must be a number".into()),
        (
            posed("<pose>nan 0 0 0 0 0</pose>"),
            "line 1, model 'm': pose = NaN: must be from -10000000 to 10000000".into(),
        ),
        (posed("<pose>1e9 0 0 0 0 0</pose>"), "pose = 1000000000: must be from".into()),
        (posed("<pose>2e6 0 0 0 0 0</pose>"), "must be from -1000000 to 1000000".into()),
        (
            posed("<pose frame='base'>0 0 0 0 0 0</pose>"),
            "line 1, model 'm': pose frame = 'base': must be empty: name the frame by relative_to".into(),
        ),
        (
            posed("<pose relative_to='base'>0 0 0 0 0 0</pose>"),
            "line 1, model 'm': relative_to = 'base': must be world, or a model, link, joint or frame beside it, or within a model there (a::b)".into(),
        ),
        (
            posed("<pose relative_to='m::link'>0 0 0 0 0 0</pose>"),
            "line 1, model 'm': relative_to = 'm::link': must be no circle, and no chain of more than 64 frames".into(),
        ),
        (
            document(
                "<joint name='j'/><frame name='f'><pose relative_to='j'/></frame><model name='m'><pose relative_to='f'/></model>",
            ),
            "line 1, joint 'j': <child> is missing".into(),
        ),
        (
            posed("<pose relative_to='m'>0 0 0 0 0 0</pose>"),
            "relative_to = 'm': must be no circle, and no chain of more than 64 frames".into(),
        ),
        (
            posed("<pose rotation_format='matrix'>0 0 0</pose>"),
            "line 1, model 'm': rotation_format = 'matrix': must be euler_rpy or quat_xyzw".into(),
        ),
        (
            posed("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose>"),
            "pose = a quaternion of length 0: must be a rotation, other than 0".into(),
        ),
        (
            document("<model name='m' placement_frame='f'/>"),
            "line 1, model 'm': placement_frame = 'f': must be __model__, or a model, link, joint or frame beside it".into(),
        ),
        (
            document(&("<model name='a'>".repeat(33) + &"</model>".repeat(33))),
            "nesting = 33: must be at most 32 models within each other".into(),
        ),
        (
            document(&format!("<a{}/>", (0..300).map(|k| format!(" b{k}=''")).collect::<String>())),
            "line 1: attributes = 300: must be at most 256 in an element".into(),
        ),
        (document(&ground.repeat(100_001)), format!("{PLACE}obstacles = more than 100000: must be at most 100000")),
        (
            document(&model("m", "0 0 9 0 0 0", triangle).repeat(33_334)),
            format!("{PLACE}polylines = 100002 corners: must be at most 100000 corners of convex parts in all"),
        ),
        (
            geometry("<mesh><uri>a.dae</uri></mesh>"),
            "cannot represent model 'm', link 'link', collision 'collision': mesh 'a.dae'".into(),
        ),
        (
            ours("<headway:room>0 0 10</headway:room>"),
            "room = 3 numbers: must be a room (x, y, width, height), a start or a goal".into(),
        ),
    ]);
}

#[test]
fn faults_of_our_scenarios_are_named() {
    let ground = model("m", "0 0 0 0 0 0", &cylinder(1.0, 1.0));
    assert_refused(vec![
        (ours("<headway:room>0 0 10 -1</headway:room>"), "room: height = -1: must be a finite number above 0".into()),
        (ours("<headway:start>0 0</headway:start>"), "start = [0.0, 0.0]: must be [x, y, yaw], or".into()),
        (ours("<headway:goal>0 0 0</headway:goal>"), "goal = [0.0, 0.0, 0.0]: must be [x, y], metres".into()),
        (
            ours("<headway:room>0 0 1 1</headway:room>").replace("</world>", &(ground.clone() + "</world>")),
            "room: obstacle 0 at (0, 0) reaches out of the 1 x 1 m room".into(),
        ),
    ]);
}

fn ours(element: &str) -> String {
    document(&format!("<headway:scenario xmlns:headway='https://headway.rs/sdf/1'>{element}</headway:scenario>"))
}

#[test]
fn bytes_that_are_no_text() {
    assert_eq!(refusal(b"<sdf>\xff</sdf>"), "no well-formed UTF-8: invalid utf-8 sequence of 1 bytes from index 5");
}

#[test]
fn deep_nesting_does_not_overflow_the_stack() {
    let n = 300_000;
    let deep = document(&("<a>".repeat(n) + &"</a>".repeat(n)));
    assert!(parse_sdf(deep.as_bytes(), &SdfSpec::default()).is_ok());
    let models = document(&("<model name='a'>".repeat(n) + &"</model>".repeat(n)));
    assert!(refusal(models.as_bytes()).contains("at most 32 models"));
}

#[test]
fn a_file_may_end_anywhere() {
    let whole = document(
        &(model("a", "1 2 0 0.1 0 0", &cylinder(1.0, 1.0))
            + &model("b", "1 2 0 0 0 0", "<box><size>1 2 3</size></box>")),
    );
    for end in 0..whole.len() {
        assert!(parse_sdf(&whole.as_bytes()[..end], &SdfSpec::default()).is_err());
    }
    for place in 0..whole.len() {
        for byte in [0, b'<', b'9', b'-', 0xff] {
            let mut spoilt = whole.clone().into_bytes();
            spoilt[place] = byte;
            let _ = parse_sdf(&spoilt, &SdfSpec::default());
        }
    }
}
