//! Do objects read back as packs have had them?

use super::*;

/// Objects as packs have had them from the beginning.
const MESH: &str = concat!(
    r#"{"name":"wall","leaf_triangles":12,"bounds":{"centre":[0.0,1.0,2.0],"radius":3.0},"#,
    r#""grid":{"origin":[0.0,0.0,0.0],"step":0.5,"bits":12},"attributes":{"normals":true,"#,
    r#""colours":false},"colour":[1.0,1.0,1.0,1.0],"two_sided":false,"#,
    r#""unlit":false,"placements":[[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0]]}"#,
);
const CLOUD: &str = concat!(
    r#"{"name":"scan","leaf_triangles":0,"bounds":{"centre":[0.0,1.0,2.0],"radius":3.0},"#,
    r#""grid":{"origin":[0.0,0.0,0.0],"step":0.5,"bits":16},"attributes":{"normals":false,"#,
    r#""colours":false},"colour":[1.0,1.0,1.0,1.0],"two_sided":true,"#,
    r#""unlit":true,"placements":[[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0]],"#,
    r#""points":{"count":34,"scale":[0.5,0.5,0.5],"offset":[0.0,0.0,0.0],"least":[-5,0,7],"#,
    r#""attributes":{"colours":true,"intensities":false,"classes":false},"colour_bits":8,"#,
    r#""colour_times":1,"most_intensity":900}}"#,
);

#[test]
fn objects_are_read_and_written_as_packs_have_them() {
    let told = [MESH, CLOUD].map(|text| {
        let object: SceneObject = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_string(&object).unwrap(), text);
        (object.shape.kind(), object.shape.samples())
    });
    assert_eq!(told, [(UnitKind::Mesh, 12), (UnitKind::Points, 34)]);
}
