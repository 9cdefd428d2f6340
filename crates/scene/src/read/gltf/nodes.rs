//! Which meshes stand where in the scene of a glTF file?

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};

use super::super::error::Fault;
use super::super::place::{MOST_PLACES, too_many};
use super::accessor::Accessors;
use super::json::{Document, InstanceAttributes, Node};

/// A mesh at a place.
pub(super) struct ShownMesh {
    pub(super) mesh: u32,
    pub(super) node: usize,
    pub(super) world_from_mesh: DAffine3,
}

/// What the nodes of the scene show, parents before children.
pub(super) fn shown(accessors: &Accessors<'_>) -> Result<Vec<ShownMesh>, Fault> {
    let document = accessors.document;
    let (order, world_from_node) = walk(document)?;
    let mut all = Vec::new();
    for node in order {
        let Some(mesh) = document.nodes[node].mesh else {
            continue;
        };
        let rest = match document.nodes[node].skin {
            Some(skin) => world_from_skinned(accessors, skin, &world_from_node)?,
            None => None,
        };
        let world_from_mesh = rest.unwrap_or(world_from_node[node]);
        let shown = |world_from_mesh| ShownMesh {
            mesh,
            node,
            world_from_mesh,
        };
        match &document.nodes[node].extensions.instances {
            None if all.len() == MOST_PLACES => return Err(too_many()),
            None => all.push(shown(world_from_mesh)),
            Some(said) => {
                let many = instances(accessors, &said.attributes, node, all.len())?;
                all.extend(many.into_iter().map(|it| shown(world_from_mesh * it)));
            }
        }
    }
    Ok(all)
}

/// Where the instances of a node stand in it; `before` stand elsewhere.
fn instances(
    accessors: &Accessors<'_>,
    said: &InstanceAttributes,
    node: usize,
    before: usize,
) -> Result<Vec<DAffine3>, Fault> {
    let named = [said.translation, said.rotation, said.scale];
    let counts = named.into_iter().flatten().map(|it| accessors.count(it));
    let counts = counts.collect::<Result<Vec<u64>, Fault>>()?;
    let count = counts.first().copied().unwrap_or(0);
    if counts.iter().any(|it| *it != count) {
        let what = format!("its instances have {counts:?} numbers of elements, which differ");
        return Err(Fault::at(place(node), what));
    }
    // Nodes may share what places their instances.
    if count > (MOST_PLACES - before) as u64 {
        return Err(too_many());
    }
    let translations = rows(accessors, said.translation, [0.0; 3], count)?;
    let rotations = rows(accessors, said.rotation, [0.0, 0.0, 0.0, 1.0], count)?;
    let scales = rows(accessors, said.scale, [1.0; 3], count)?;
    let all = translations.into_iter().zip(rotations).zip(scales);
    all.map(|((translation, rotation), scale)| placed(translation, rotation, scale, node))
        .collect()
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

/// The nodes of the scene, and where each of all nodes stands in it.
fn walk(document: &Document) -> Result<(Vec<usize>, Vec<DAffine3>), Fault> {
    let nodes = &document.nodes;
    let mut world_from_node = vec![DAffine3::IDENTITY; nodes.len()];
    let mut met = vec![false; nodes.len()];
    let mut order = Vec::new();
    // Each with its parent.
    let mut next: Vec<(u32, Option<usize>)> = Vec::new();
    next.extend(roots(document)?.iter().rev().map(|root| (*root, None)));
    while let Some((number, parent)) = next.pop() {
        let node = number as usize;
        let Some(said) = nodes.get(node) else {
            let what = format!("is named, but there are only {} nodes", nodes.len());
            return Err(Fault::at(place(node), what));
        };
        if met[node] {
            let what = "is met twice in the scene: it has two parents, or is in itself";
            return Err(Fault::at(place(node), what));
        }
        met[node] = true;
        let parent_from_node = parent_from_node(said, node)?;
        world_from_node[node] = match parent {
            Some(parent) => world_from_node[parent] * parent_from_node,
            None => parent_from_node,
        };
        order.push(node);
        let children = said.children.iter().rev();
        next.extend(children.map(|child| (*child, Some(node))));
    }
    Ok((order, world_from_node))
}

/// The roots of the scene to show; without scenes, all nodes that are no child.
fn roots(document: &Document) -> Result<Vec<u32>, Fault> {
    if document.scenes.is_empty() {
        let mut is_child = vec![false; document.nodes.len()];
        for child in document.nodes.iter().flat_map(|node| &node.children) {
            if let Some(is_child) = is_child.get_mut(*child as usize) {
                *is_child = true;
            }
        }
        let all = 0..document.nodes.len() as u32;
        return Ok(all.filter(|node| !is_child[*node as usize]).collect());
    }
    let number = document.scene.unwrap_or(0);
    let Some(scene) = document.scenes.get(number as usize) else {
        let what = format!(
            "is to be shown, but there are only {}",
            document.scenes.len()
        );
        return Err(Fault::at(format!("scene {number}"), what));
    };
    Ok(scene.nodes.clone())
}

fn parent_from_node(said: &Node, node: usize) -> Result<DAffine3, Fault> {
    if let Some(matrix) = &said.matrix {
        return affine(matrix)
            .ok_or_else(|| Fault::at(place(node), "the last row of its matrix is not 0, 0, 0, 1"));
    }
    let translation = said.translation.as_deref().copied().unwrap_or([0.0; 3]);
    let scale = said.scale.as_deref().copied().unwrap_or([1.0; 3]);
    let rotation = said.rotation.as_deref().copied();
    let rotation = rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    placed(translation, rotation, scale, node)
}

fn placed(
    translation: [f64; 3],
    rotation: [f64; 4],
    scale: [f64; 3],
    node: usize,
) -> Result<DAffine3, Fault> {
    let turn = DVec4::from_array(rotation);
    let Some(turn) = turn.try_normalize() else {
        let what = format!("its rotation is {turn}, which is none");
        return Err(Fault::at(place(node), what));
    };
    Ok(DAffine3::from_scale_rotation_translation(
        DVec3::from_array(scale),
        DQuat::from_vec4(turn),
        DVec3::from_array(translation),
    ))
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
) -> Result<Option<DAffine3>, Fault> {
    let Some(said) = accessors.document.skins.get(skin as usize) else {
        let what = format!("there are only {} skins", accessors.document.skins.len());
        return Err(Fault::at(format!("skin {skin}"), what));
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
    let first = accessors.first_matrix(matrices)?;
    let joint_from_mesh = first.as_ref().and_then(affine);
    Ok(joint_from_mesh.map(|joint_from_mesh| *world_from_joint * joint_from_mesh))
}
