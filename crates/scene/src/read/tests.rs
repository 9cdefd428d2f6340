//! Are files on disk read into one scene, and others left alone?

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{ReadError, ReadOptions, Up, is_scene_file, read};

/// A folder of its own, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("foveal-scene-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn put(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n";
const MTL: &str = "newmtl red\nKd 1 0 0\n";
const STL: &str =
    "solid a\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 3\nendloop\nendsolid\n";

fn refusal(path: &Path) -> String {
    let error = read(&[path], &ReadOptions::default()).unwrap_err();
    error.to_string()
}

#[test]
fn several_files_stand_in_one_scene_with_their_own_materials() {
    let folder = Folder::new("several");
    let obj = folder.put("Dull Rock.OBJ", OBJ);
    let mtl = folder.put("a.mtl", MTL);
    let stl = folder.put("b.stl", STL);
    let scene = read(&[&stl, &obj, &stl], &ReadOptions::default()).unwrap();
    let names: Vec<&str> = scene
        .objects
        .iter()
        .map(|object| object.name.as_str())
        .collect();
    assert_eq!(names, ["b", "Dull Rock", "b"]);
    assert_eq!(scene.meshes[1].materials, [1]);
    assert_eq!(scene.meshes[2].materials, [2]);
    assert_eq!(scene.materials[1].name, "red");
    let bytes = 2 * STL.len() + OBJ.len() + fs::read(mtl).unwrap().len();
    assert_eq!(scene.bytes, bytes as u64);
}

#[test]
fn z_is_up_in_stl_and_where_it_is_said_so() {
    let folder = Folder::new("up");
    let stl = folder.put("a.stl", STL);
    let stands = |up: Option<Up>| {
        let options = ReadOptions {
            up,
            ..ReadOptions::default()
        };
        let scene = read(&[&stl], &options).unwrap();
        scene.objects[0].placements[0].transform_point3(scene.meshes[0].positions[2])
    };
    assert_eq!(stands(None), DVec3::new(0.0, 3.0, -2.0));
    assert_eq!(stands(Some(Up::Z)), stands(None));
    assert_eq!(stands(Some(Up::Y)), DVec3::new(0.0, 2.0, 3.0));
}

#[test]
fn endings_that_are_read_are_known() {
    for name in ["a.glb", "b/a.GLTF", "a.vrm", "a.obj", "a.ply", "a.b.stl"] {
        assert!(is_scene_file(Path::new(name)), "{name}");
    }
    for name in ["a.fbx", "obj", ".obj", "a.obj.gz", ""] {
        assert!(!is_scene_file(Path::new(name)), "{name}");
    }
    let endings = ".glb, .gltf, .vrm, .obj, .ply, .stl, .las, .laz or .toml";
    assert!(refusal(Path::new("a.xyzw")).contains(endings));
    assert!(refusal(Path::new("a.fbx")).contains("Blender"));
    let none = read(&[], &ReadOptions::default());
    assert!(matches!(none, Err(ReadError::NoFile)));
}

#[test]
fn files_that_are_not_there_or_are_none_are_refused() {
    let folder = Folder::new("none");
    assert!(refusal(&folder.0.join("a.obj")).contains("cannot be read"));
    fs::create_dir(folder.0.join("b.obj")).unwrap();
    assert!(refusal(&folder.0.join("b.obj")).contains("no regular file"));
    let empty = folder.put("c.obj", "v 0 0 0\nv 1 1 1\nl 1 2\n");
    let refused = refusal(&empty);
    assert!(
        refused.contains("nothing to draw: the file has only lines (1)"),
        "{refused}"
    );
}

#[cfg(unix)]
#[test]
fn links_are_followed_inside_the_folder_only() {
    let folder = Folder::new("links");
    fs::create_dir(folder.0.join("in")).unwrap();
    folder.put("out.mtl", MTL);
    folder.put("in/real.mtl", MTL);
    let obj = folder.put("in/a.obj", OBJ);
    let link = folder.0.join("in/a.mtl");
    std::os::unix::fs::symlink("real.mtl", &link).unwrap();
    let scene = read(&[&obj], &ReadOptions::default()).unwrap();
    assert_eq!(scene.materials[0].colour, [1.0, 0.0, 0.0, 1.0]);
    for outside in ["../out.mtl", "/dev/zero"] {
        fs::remove_file(&link).unwrap();
        std::os::unix::fs::symlink(outside, &link).unwrap();
        let scene = read(&[&obj], &ReadOptions::default()).unwrap();
        assert_eq!(scene.materials[0].colour, [1.0; 4]);
        let told = &scene.remarks[0];
        assert!(told.contains("does not lie in the folder"), "{told}");
    }
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink("../out.mtl", &link).unwrap();
    let allowed = ReadOptions {
        allow_outside: true,
        ..ReadOptions::default()
    };
    let scene = read(&[&obj], &allowed).unwrap();
    assert_eq!(scene.materials[0].colour, [1.0, 0.0, 0.0, 1.0]);
}
