//! What is each unit of a scene worth, by pictures of all its levels?
//!
//! The reference for signatures: each level is drawn whole, and what differs between two
//! is what an eye gets of the units that refine the coarser one. Takes as many pictures as there
//! are levels, and as many passes over them.

use crate::error::PlayError;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::scene::worth::{parameters_of_morphs, visible_errors};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::footprints::{Footprint, Footprints, Measured};
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::unit_states::Piece;
use foveal_core::view::eye_view::EyeView;
use foveal_media::pack::scene_file::SceneFile;
use foveal_render::importance::{Importance, UnitIds, upload_picture};
use foveal_render::{DrawDevice, Drawer, Gpu};
use std::sync::Arc;

/// Bytes that all units may take on the GPU.
const MOST_BYTES: u64 = u64::MAX / 4;

/// Draws levels, and compares them.
pub(crate) struct RenderedWorth {
    file: Arc<SceneFile>,
    gpu: Gpu,
    importance: Option<([u32; 2], Importance)>,
    parameters: Parameters,
    /// What was measured last, and for which moment.
    last: Option<(Moment, Measured)>,
}

impl RenderedWorth {
    /// Judges the units of a scene for an eye with these parameters.
    pub(crate) fn new(file: &Arc<SceneFile>, gpu: &Gpu, parameters: &Parameters) -> Self {
        Self {
            file: Arc::clone(file),
            gpu: gpu.clone(),
            importance: None,
            parameters: parameters_of_morphs(parameters),
            last: None,
        }
    }

    /// What each unit is worth at a moment, through the view where it is worth most.
    ///
    /// # Errors
    /// The device was lost.
    pub(crate) fn measured(&mut self, moment: &Moment) -> Result<Measured, PlayError> {
        if let Some((_, measured)) = self.last.as_ref().filter(|(last, _)| {
            last.views == moment.views
                && last.gaze.gaze_in_content == moment.gaze.gaze_in_content
                && last.state == moment.state
        }) {
            return Ok(measured.clone());
        }
        let mut worths: Vec<f64> = Vec::new();
        for view in &moment.views {
            let own = self.worths(moment, view)?;
            worths.resize(own.len(), 0.0);
            for (most, own) in worths.iter_mut().zip(own) {
                *most = most.max(own);
            }
        }
        let measured = Measured::worths(&worths);
        self.last = Some((moment.clone(), measured.clone()));
        Ok(measured)
    }

    /// What each unit is worth through a view.
    fn worths(&mut self, moment: &Moment, view: &EyeView) -> Result<Vec<f64>, PlayError> {
        let onlooker = Onlooker {
            view: *view,
            gaze: Gaze {
                direction: moment.gaze.gaze_in_content,
                spread: moment.gaze.spread,
            },
            state: moment.state,
        };
        let scene = Arc::clone(self.file.scene());
        let device = DrawDevice::Gpu(self.gpu.clone());
        let mut drawer = Drawer::of_scene(&device, &scene, MOST_BYTES)?;
        let mut worths = vec![0.0; scene.pack().len()];
        let mut coarser = None;
        for level in (0..=scene.pack().coarsest()).rev() {
            self.upload_level(&mut drawer, level)?;
            let Some(picture) = drawer.picture(view, None)? else {
                break;
            };
            let picture = upload_picture(&self.gpu, &picture)?;
            if let Some((coarser, ids)) = coarser.as_ref() {
                let importance = self.importance(view.size)?;
                let gains = importance.run(&[&picture, coarser], ids, &onlooker)?;
                let gains = gains.per_step.iter().flatten();
                worths
                    .iter_mut()
                    .zip(gains)
                    .for_each(|(worth, gain)| *worth += gain);
            }
            let ids = match drawer.scene_mut() {
                Some(scene) => scene.ids(view)?,
                None => None,
            };
            let ids = ids.map(|texture| UnitIds {
                texture: texture.clone(),
                units: worths.len(),
            });
            coarser = ids.map(|ids| (picture, ids));
        }
        Ok(worths)
    }

    /// Shows all units of a level.
    fn upload_level(&self, drawer: &mut Drawer, level: u8) -> Result<(), PlayError> {
        let pack = self.file.pack();
        for unit in pack.units().filter(|unit| pack.level_of(*unit) == level) {
            let asset = AssetId::ONLY;
            let piece = Piece {
                unit: UnitRef { asset, unit },
                frame: 0,
            };
            // Damaged units, and units that do not fit the others, are found by the player.
            let Ok(payload) = self.file.read_unit(unit) else {
                continue;
            };
            match drawer.upload(piece, payload) {
                Err(error) if !error.is_of_unit() => return Err(error.into()),
                _ => {}
            }
        }
        Ok(())
    }

    /// What compares pictures of this size.
    fn importance(&mut self, size: [u32; 2]) -> Result<&mut Importance, PlayError> {
        let fitting = self.importance.take().filter(|(of, _)| *of == size);
        let fitting = match fitting {
            Some(fitting) => fitting,
            None => (size, Importance::new(&self.gpu, size, &self.parameters)?),
        };
        Ok(&mut self.importance.insert(fitting).1)
    }
}

/// Visible error that units of a scene remove at a moment, of those that refine something that is
/// seen: by signatures and footprints, and by pictures of all levels.
///
/// # Errors
/// A unit is damaged, or the device was lost.
pub fn worth_both_ways(
    file: &Arc<SceneFile>,
    gpu: &Gpu,
    moment: &Moment,
) -> Result<[Vec<f64>; 2], PlayError> {
    let Some(view) = moment.views.first() else {
        return Ok([Vec::new(), Vec::new()]);
    };
    let config = PolicyConfig::new(Policy::Perceptual);
    let mut rendered = RenderedWorth::new(file, gpu, &config.perception);
    let scene = Arc::clone(file.scene());
    let mut drawer = Drawer::of_scene(&DrawDevice::Gpu(gpu.clone()), &scene, MOST_BYTES)?;
    let mut footprints = Vec::new();
    for level in (1..=scene.pack().coarsest()).rev() {
        rendered.upload_level(&mut drawer, level)?;
        if let Some(scene) = drawer.scene_mut() {
            footprints.extend_from_slice(scene.footprints(moment)?.list());
        }
    }
    let footprints = Footprints::new(footprints);
    let by_signatures = visible_errors(&scene, moment, &footprints);
    let by_pictures = rendered.worths(moment, view)?;
    let seen = |worths: Vec<f64>| {
        let of = |it: &Footprint| worths.get(it.unit.0 as usize).copied();
        footprints.list().iter().filter_map(of).collect()
    };
    Ok([seen(by_signatures), seen(by_pictures)])
}
