//! Which meshes stand where in the scene of a glTF file?

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};

use super::super::error::Fault;
use super::super::mends::{
    Mends, NODE_IN_ITSELF, NODE_NOT_FOUND, NODE_PLACED_TWICE, NODE_SHARED, PLACE_MENDED,
    SCENE_NOT_FOUND,
};
use super::super::place::{MOST_PLACES, too_many};
use super::accessor::Accessors;
use super::json::{Document, InstanceAttributes, Node};

/// A mesh at a place.
pub(super) struct ShownMesh {
    pub(super) mesh: u32,
    /// The node that shows it; none in a file without nodes.
    pub(super) node: Option<usize>,
    pub(super) world_from_mesh: DAffine3,
}

/// What the nodes of the scene show, parents before children. What they name that is not there, or
/// has no meaning, is left out; refused are more places than a scene may have.
pub(super) fn shown(accessors: &Accessors<'_>, mends: &mut Mends) -> Result<Vec<ShownMesh>, Fault> {
    let document = accessors.document;
    if document.nodes.is_empty() {
        return Ok(without_nodes(document, mends));
    }
    let (order, world_from_node) = walk(document, mends)?;
    let mut all = Vec::new();
    for (node, at) in order {
        let Some(mesh) = document.nodes[node].mesh else {
            continue;
        };
        if mesh as usize >= document.meshes.len() {
            mends.add(NODE_NOT_FOUND, 1, || {
                format!("is mesh {mesh}, named by {}", place(node))
            });
            continue;
        }
        let skin = document.nodes[node].skin;
        let rest = skin.map(|skin| world_from_skinned(accessors, skin, &world_from_node));
        let rest = rest.transpose().unwrap_or_else(|what| {
            mends.add(PLACE_MENDED, 1, || format!("is of {}: {what}", place(node)));
            None
        });
        let world_from_mesh = rest.flatten().unwrap_or(at);
        let shown = |world_from_mesh| ShownMesh {
            mesh,
            node: Some(node),
            world_from_mesh,
        };
        match &document.nodes[node].extensions.instances {
            None if all.len() == MOST_PLACES => return Err(too_many()),
            None => all.push(shown(world_from_mesh)),
            Some(said) => {
                let many = instances(accessors, &said.attributes, all.len())?;
                let many = many.unwrap_or_else(|what| {
                    mends.add(PLACE_MENDED, 1, || format!("is of {}: {what}", place(node)));
                    vec![DAffine3::IDENTITY]
                });
                if all.len() + many.len() > MOST_PLACES {
                    return Err(too_many());
                }
                all.extend(many.into_iter().map(|it| shown(world_from_mesh * it)));
            }
        }
    }
    Ok(all)
}

/// All meshes of a file without nodes.
fn without_nodes(document: &Document, mends: &mut Mends) -> Vec<ShownMesh> {
    let all = 0..document.meshes.len().min(MOST_PLACES) as u32;
    mends.add(SCENE_NOT_FOUND, usize::from(!all.is_empty()), || {
        "is one of all meshes, as there are no nodes".to_owned()
    });
    let shown = all.map(|mesh| ShownMesh {
        mesh,
        node: None,
        world_from_mesh: world_from_roots(document),
    });
    shown.collect()
}

/// Where the instances of a node stand in it, or why that cannot be known; `before` stand
/// elsewhere.
fn instances(
    accessors: &Accessors<'_>,
    said: &InstanceAttributes,
    before: usize,
) -> Result<Result<Vec<DAffine3>, String>, Fault> {
    let named = [said.translation, said.rotation, said.scale];
    let counts = named.into_iter().flatten().map(|it| accessors.count(it));
    let counts = match counts.collect::<Result<Vec<u64>, Fault>>() {
        Ok(counts) => counts,
        Err(fault) => return Ok(Err(fault.what())),
    };
    let count = counts.iter().copied().min().unwrap_or(0);
    // Nodes may share what places their instances.
    if counts.iter().any(|it| *it > (MOST_PLACES - before) as u64) {
        return Err(too_many());
    }
    let read = || -> Result<Vec<DAffine3>, Fault> {
        let translations = rows(accessors, said.translation, [0.0; 3], count)?;
        let rotations = rows(accessors, said.rotation, [0.0, 0.0, 0.0, 1.0], count)?;
        let scales = rows(accessors, said.scale, [1.0; 3], count)?;
        let all = translations.into_iter().zip(rotations).zip(scales);
        // One with an invalid rotation is not turned.
        let place = |((translation, rotation), scale)| placed(translation, rotation, scale).0;
        Ok(all.map(place).collect())
    };
    let all = read().map_err(Fault::what);
    Ok(match counts.iter().any(|it| *it != count) {
        true => Err(format!("its instances have {counts:?} numbers of elements")),
        false => all,
    })
}

/// The elements of an accessor, or as many as it would have of what stands in for it.
fn rows<const N: usize>(
    accessors: &Accessors<'_>,
    number: Option<u32>,
    without: [f64; N],
    count: u64,
) -> Result<Vec<[f64; N]>, Fault> {
    match number {
        Some(number) => accessors.rows::<N>(number, &[N]),
        None => Ok(vec![without; count as usize]),
    }
}

fn place(node: usize) -> String {
    format!("node {node}")
}

/// Nodes with where they stand in the world.
type Placed = Vec<(usize, DAffine3)>;

/// What is next on a walk: a node below a parent, or the end of all that is below a node.
enum Step {
    Enter(u32, Option<usize>),
    Leave(usize),
}

/// The nodes of the scene with where they stand, and where each of all nodes stands.
fn walk(document: &Document, mends: &mut Mends) -> Result<(Placed, Vec<DAffine3>), Fault> {
    let nodes = &document.nodes;
    let mut world_from_node = vec![DAffine3::IDENTITY; nodes.len()];
    let (mut met, mut is_above) = (vec![false; nodes.len()], vec![false; nodes.len()]);
    let mut order = Vec::new();
    let roots = roots(document, mends);
    let mut next: Vec<Step> = roots.iter().map(|root| Step::Enter(*root, None)).collect();
    next.reverse();
    while let Some(step) = next.pop() {
        let (number, parent) = match step {
            Step::Enter(number, parent) => (number, parent),
            Step::Leave(node) => {
                is_above[node] = false;
                continue;
            }
        };
        let node = number as usize;
        let Some(said) = nodes.get(node) else {
            mends.add(NODE_NOT_FOUND, 1, || format!("is {}", place(node)));
            continue;
        };
        if is_above[node] {
            mends.add(NODE_IN_ITSELF, 1, || format!("is {}", place(node)));
            continue;
        }
        let times = usize::from(met[node]);
        mends.add(NODE_SHARED, times, || format!("is {}", place(node)));
        // Nodes that are shared below shared ones are met ever more often.
        if order.len() >= nodes.len() + MOST_PLACES {
            return Err(too_many());
        }
        (met[node], is_above[node]) = (true, true);
        let twice = usize::from(is_placed_twice(said));
        mends.add(NODE_PLACED_TWICE, twice, || format!("is {}", place(node)));
        let (parent_from_node, wrong) = parent_from_node(said);
        if let Some(what) = wrong {
            mends.add(PLACE_MENDED, 1, || format!("is of {}: {what}", place(node)));
        }
        world_from_node[node] = match parent {
            Some(parent) => world_from_node[parent] * parent_from_node,
            None => world_from_roots(document) * parent_from_node,
        };
        order.push((node, world_from_node[node]));
        next.push(Step::Leave(node));
        let children = said.children.iter().rev();
        next.extend(children.map(|child| Step::Enter(*child, Some(node))));
    }
    Ok((order, world_from_node))
}

/// Where all roots are placed.
fn world_from_roots(document: &Document) -> DAffine3 {
    let centre = document.extensions.centre.as_ref();
    DAffine3::from_translation(centre.map_or(DVec3::ZERO, |it| it.center.into()))
}

/// The roots of the scene to show; without scenes, all nodes that are no child, or, where each is
/// one of another, all.
fn roots(document: &Document, mends: &mut Mends) -> Vec<u32> {
    let number = document.scene.unwrap_or(0) as usize;
    let scenes = &document.scenes;
    let is_lost = number >= scenes.len() && !scenes.is_empty();
    mends.add(SCENE_NOT_FOUND, usize::from(is_lost), || {
        format!("is scene {number} of {}: scene 0 is shown", scenes.len())
    });
    if let Some(scene) = scenes.get(number).or(scenes.first()) {
        return scene.nodes.clone();
    }
    let mut is_child = vec![false; document.nodes.len()];
    for (node, at) in document.nodes.iter().zip(0..) {
        for child in node.children.iter().filter(|it| **it != at) {
            if let Some(is_child) = is_child.get_mut(*child as usize) {
                *is_child = true;
            }
        }
    }
    let all = 0..document.nodes.len() as u32;
    let free: Vec<u32> = all
        .clone()
        .filter(|node| !is_child[*node as usize])
        .collect();
    match free.is_empty() {
        true => all.take(1).collect(),
        false => free,
    }
}

/// Whether a node has a matrix and also says otherwise where it stands, other than as it would
/// without.
fn is_placed_twice(said: &Node) -> bool {
    let moves = said
        .translation
        .as_deref()
        .is_some_and(|it| *it != [0.0; 3]);
    let turns = said.rotation.as_deref();
    let turns = turns.is_some_and(|it| *it != [0.0, 0.0, 0.0, 1.0]);
    let scales = said.scale.as_deref().is_some_and(|it| *it != [1.0; 3]);
    said.matrix.is_some() && (moves || turns || scales)
}

/// Where a node stands below its parent, and what of that has no meaning.
fn parent_from_node(said: &Node) -> (DAffine3, Option<&'static str>) {
    if let Some(matrix) = &said.matrix {
        let what = "the last row of its matrix is not 0, 0, 0, 1";
        return match affine(matrix) {
            Some(affine) => (affine, None),
            None => (
                DAffine3::from_mat4(DMat4::from_cols_array(matrix)),
                Some(what),
            ),
        };
    }
    let translation = said.translation.as_deref().copied().unwrap_or([0.0; 3]);
    let scale = said.scale.as_deref().copied().unwrap_or([1.0; 3]);
    let rotation = said.rotation.as_deref().copied();
    let rotation = rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    placed(translation, rotation, scale)
}

/// The same of its parts; an invalid rotation does not turn.
fn placed(
    translation: [f64; 3],
    rotation: [f64; 4],
    scale: [f64; 3],
) -> (DAffine3, Option<&'static str>) {
    let turn = DVec4::from_array(rotation).try_normalize();
    let wrong = turn.is_none().then_some("its rotation is invalid");
    let turn = turn.map_or(DQuat::IDENTITY, DQuat::from_vec4);
    let scale = DVec3::from_array(scale);
    let placed = DAffine3::from_scale_rotation_translation(scale, turn, translation.into());
    (placed, wrong)
}

fn affine(columns: &[f64; 16]) -> Option<DAffine3> {
    // Programs that multiply matrices in f32 leave such errors.
    const ROUNDING: f64 = 1e-4;
    let matrix = DMat4::from_cols_array(columns);
    let off = matrix.row(3) - DVec4::W;
    (off.abs().max_element() <= ROUNDING).then(|| DAffine3::from_mat4(matrix))
}

/// Where the mesh of a skin stands at rest: its first joint carries it. The node of the mesh has
/// no say, by section 3.7.3.3 of the specification.
fn world_from_skinned(
    accessors: &Accessors<'_>,
    skin: u32,
    world_from_node: &[DAffine3],
) -> Result<Option<DAffine3>, String> {
    let Some(said) = accessors.document.skins.get(skin as usize) else {
        let count = accessors.document.skins.len();
        return Err(format!("its skin {skin} is one of {count}"));
    };
    let joint = said
        .joints
        .first()
        .and_then(|joint| world_from_node.get(*joint as usize));
    let Some(world_from_joint) = joint else {
        return Ok(None);
    };
    let Some(matrices) = said.inverse_bind_matrices else {
        return Ok(Some(*world_from_joint));
    };
    let first = accessors.first_matrix(matrices).map_err(Fault::what)?;
    let joint_from_mesh = first.as_ref().and_then(affine);
    Ok(joint_from_mesh.map(|joint_from_mesh| *world_from_joint * joint_from_mesh))
}
