//! How does a view of a scene's units become a picture on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;
use crate::gpu::readback::{PictureCopy, ReadBack};
use crate::gpu::room::GpuRoom;
use crate::idle::IdleUnits;
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::importance::marks::UnitMarks;
use crate::scene::coming::{Coming, Refiners};
use crate::scene::footprints::{FootprintPass, FootprintsBack, GazedParams, small_view};
use crate::scene::kind::{Frame, KindLayer, Textures};
use crate::scene::params::{SceneParams, SceneStyle};
use crate::scene::phase::{Go, Phase};
use crate::scene::placements::Placements;
use crate::scene::targets::SceneTarget;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::glance::Glance;
use foveal_core::view::eye_view::EyeView;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// The units of a scene on the GPU, and the pictures that are drawn of them.
///
/// Units of each kind are a layer; all layers are drawn into the same pictures, and share one bound
/// of memory.
///
/// ```no_run
/// # use foveal_core::content::scene::description::SceneDescription;
/// # use foveal_core::view::eye_view::EyeView;
/// # use foveal_render::{Coming, Gpu, SceneLayer, SceneStyle};
/// # fn show(about: &SceneDescription, root: &Coming<'_>, view: &EyeView)
/// # -> Result<(), foveal_render::RenderError> {
/// let gpu = Gpu::open_blocking()?;
/// let mut layer = SceneLayer::new(&gpu, &about.objects, &about.textures, 256 << 20)?;
/// layer.upload(root)?;
/// let image = layer.picture(view, &SceneStyle::default())?;
/// # Ok(()) }
/// ```
pub struct SceneLayer {
    gpu: Gpu,
    layers: Vec<Box<dyn KindLayer>>,
    room: GpuRoom,
    /// Bytes that pictures will take that were not drawn yet.
    expected: u64,
    placements: Arc<Placements>,
    view: wgpu::Buffer,
    seen_placements: wgpu::Buffer,
    colours: SceneTarget,
    ids: Option<SceneTarget>,
    footprints: Option<FootprintPass>,
    /// One more than the largest number of a unit that refines something.
    refining_units: u32,
    /// What units are worth, where pictures are to show that.
    marks: Option<UnitMarks>,
}

impl SceneLayer {
    /// These layers of objects that stand there, whose units may use `most_bytes`.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub fn of_layers(
        gpu: &Gpu,
        layers: Vec<Box<dyn KindLayer>>,
        placements: Arc<Placements>,
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let view_bytes = size_of::<SceneParams>() as u64;
        let uniform = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_SRC;
        Ok(Self {
            gpu: gpu.clone(),
            layers,
            room: GpuRoom::new(most_bytes),
            expected: 0,
            view: written(gpu, "view of a scene", view_bytes, uniform),
            seen_placements: storage(gpu, "placements of objects", placements.bytes())?,
            placements,
            colours: SceneTarget::new(gpu, Phase::Opaque),
            ids: None,
            footprints: None,
            refining_units: 0,
            marks: None,
        })
    }

    /// Adds a unit after its prerequisites; one that is there stays as it is. `false` where
    /// there is no room for it and what is coarser is shown.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload(&mut self, coming: &Coming<'_>) -> Result<bool, RenderError> {
        let mut layers = self.layers.iter();
        let Some(number) = layers.position(|layer| layer.takes(coming)) else {
            return Err(RenderError::OtherKind);
        };
        self.balance();
        let left = self.room.left_for(number);
        let uploaded = self.layers[number].upload(coming, left);
        let must = match &uploaded {
            Ok(false) => false,
            // Others hold more than they use.
            Err(RenderError::NoRoom { bytes, .. }) if *bytes <= left.used => true,
            _ => return uploaded,
        };
        for (_, layer) in (0..)
            .zip(&mut self.layers)
            .filter(|(other, _)| *other != number)
        {
            layer.give_back(must)?;
        }
        self.balance();
        let left = match must {
            true => self.room.promised_to(number),
            false => self.room.left_for(number),
        };
        self.layers[number].upload(coming, left)
    }

    /// Enters into the ledger what is taken.
    fn balance(&mut self) {
        let pictures = self.picture_bytes(None).max(self.expected);
        let tables = self.table_bytes();
        let layers = self.layers.iter().map(|layer| layer.taken());
        self.room.balance(layers, pictures, tables);
    }

    /// Takes back what stays without being drawn where more is held than may be.
    fn tighten(&mut self) -> Result<(), RenderError> {
        self.balance();
        if self.room.is_over() {
            for layer in &mut self.layers {
                layer.give_back(false)?;
            }
        }
        Ok(())
    }

    /// Bytes of what finds units, of any number of them.
    fn table_bytes(&self) -> u64 {
        let layers = self.layers.iter().map(|layer| layer.table_bytes());
        layers.sum::<u64>() + self.seen_placements.size()
    }

    /// Bytes of all that is drawn on, for pictures of a view too, if there is one.
    fn picture_bytes(&self, view: Option<&EyeView>) -> u64 {
        let largest = |target: &SceneTarget, size: Option<[u32; 2]>| {
            let there = SceneTarget::bytes_of(target.size());
            there.max(size.map_or(0, SceneTarget::bytes_of))
        };
        let colours = largest(&self.colours, view.map(|it| it.size));
        let small = view.map(|it| small_view(it).size);
        let ids = self.ids.as_ref().map_or(0, |ids| largest(ids, small));
        let size = view.map_or([0; 2], |it| it.size);
        let layers = self.layers.iter().map(|layer| layer.picture_bytes(size));
        colours + ids + layers.sum::<u64>()
    }

    /// Keeps room for the pictures of these views, and returns how many bytes units may use next
    /// to them.
    ///
    /// # Errors
    /// None that there was not before.
    pub fn expect(&mut self, views: &[EyeView]) -> Result<u64, RenderError> {
        let bytes = views.iter().map(|view| self.picture_bytes(Some(view)));
        self.expected = bytes.max().unwrap_or_default();
        self.tighten()?;
        Ok(self.room.for_units())
    }

    /// Takes a unit away; what it replaced is drawn again.
    ///
    /// # Panics
    /// No other that is there may need it.
    pub fn remove(&mut self, unit: UnitId) {
        let mut layers = self.layers.iter_mut();
        let _ = layers.any(|layer| layer.remove(unit));
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub fn retain(&mut self, wanted: &HashSet<UnitId>) {
        self.keep(wanted, &[]);
    }

    /// Draws only units that are wanted, what these need, and roots. Of the others those stay that
    /// are `staying`, first what is to stay longest, until their places are needed.
    pub fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        self.layers
            .iter_mut()
            .for_each(|layer| layer.keep(wanted, staying));
    }

    /// Draws a unit again that stayed, after those that it needs; `false` where it did not stay.
    pub fn show(&mut self, unit: UnitId) -> bool {
        self.layers.iter_mut().any(|layer| layer.show(unit))
    }

    /// These do not give way, until others are spared: they are about to be drawn again.
    pub fn spare(&mut self, units: &[UnitId]) {
        let idle = self.layers.iter_mut().filter_map(|layer| layer.idle());
        idle.for_each(|idle| idle.spare(units));
    }

    /// Units that stayed and gave way since this was last asked.
    pub fn take_evicted(&mut self) -> Vec<UnitId> {
        let idle = self.layers.iter_mut().filter_map(|layer| layer.idle());
        idle.flat_map(IdleUnits::take_evicted).collect()
    }

    /// From now on these units have gone so much of their way from what is coarser, 0 to 1, and all
    /// others are in their places. Writes what moves to the GPU: sixteen bytes a vertex of a mesh.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        self.layers.iter_mut().for_each(|layer| layer.morph(shares));
    }

    /// From now on these are the units that would refine parts of others: what [`Self::ids`] shows.
    /// Only those of units that are there or will be are needed.
    pub fn set_refiners(&mut self, refiners: Refiners) {
        let units = refiners.values().map(|unit| unit.0 + 1);
        self.refining_units = units.max().unwrap_or_default();
        let refiners = Arc::new(refiners);
        self.layers
            .iter_mut()
            .for_each(|layer| layer.set_refiners(&refiners));
        self.footprints = None;
    }

    /// Bytes of GPU memory of units, in use or kept for more, of tables, and of pictures with their
    /// depths.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let units: u64 = self.layers.iter().map(|layer| layer.taken().held).sum();
        units + self.table_bytes() + self.picture_bytes(None)
    }

    /// Triangles of the clusters that the last picture was drawn of, also of those that cannot be
    /// seen, each where it stands.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        self.layers.iter().map(|layer| layer.triangles()).sum()
    }

    /// Number of clusters that the last picture was drawn of: those that the picture before did not
    /// hide, and those that it did but this did not. Blocks.
    ///
    /// # Errors
    /// The device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn clusters_drawn(&self) -> Result<[u32; 2], RenderError> {
        let mut drawn = [0; 2];
        for layer in &self.layers {
            for (sum, count) in drawn.iter_mut().zip(layer.clusters_drawn()?) {
                *sum += count;
            }
        }
        Ok(drawn)
    }

    /// Draws the picture that `view` shows, and returns its rgba8 texture of sRGB codes; the next
    /// call reuses it.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn draw(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<&wgpu::Texture, RenderError> {
        self.draw_over(None, view, style)
    }

    /// The same in front of a picture of the view's size, in place of the style's background.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn draw_over(
        &mut self,
        under: Option<&wgpu::Texture>,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<&wgpu::Texture, RenderError> {
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("scene");
        self.record(&mut encoder, view, style, under)?;
        gpu.submit(encoder);
        if let Some(marks) = self.marks.take() {
            let units = self.ids(view, style)?.clone();
            marks.paint(&gpu, &units, &self.colours.image_view());
            self.marks = Some(marks);
        }
        Ok(self.colours.image())
    }

    /// From now on paints over pictures what the unit is worth that would refine what a pixel
    /// shows, 0 to 1 by its number, less than 0 where that is not known; or nothing.
    ///
    /// # Errors
    /// The device binds no buffer for as many units.
    pub fn mark(&mut self, worths: Option<&[f32]>) -> Result<(), RenderError> {
        match (&mut self.marks, worths) {
            (Some(marks), Some(worths)) => marks.fill(&self.gpu, worths)?,
            (None, Some(worths)) => self.marks = Some(UnitMarks::new(&self.gpu, worths)?),
            (marks, None) => *marks = None,
        }
        Ok(())
    }

    /// [`Self::draw`], with the picture on its way back to the CPU.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn read(&mut self, view: &EyeView, style: &SceneStyle) -> Result<ReadBack, RenderError> {
        self.read_over(None, view, style)
    }

    /// [`Self::draw_over`], with the picture on its way back to the CPU.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn read_over(
        &mut self,
        under: Option<&wgpu::Texture>,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<ReadBack, RenderError> {
        let gpu = self.gpu.clone();
        self.draw_over(under, view, style)?;
        let mut encoder = gpu.encoder("scene to read");
        let copy = PictureCopy::record(&gpu, &mut encoder, self.colours.image());
        gpu.submit(encoder);
        Ok(copy.map())
    }

    /// The picture that `view` shows; blocks until it is there.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn picture(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<RgbaImage, RenderError> {
        self.read(view, style)?.wait(&self.gpu)
    }

    /// An r32uint texture: for each pixel of `view` the unit that would refine what is drawn there,
    /// by its number; 4294967295 where none would, and where nothing stands. The next call reuses
    /// it.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn ids(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<&wgpu::Texture, RenderError> {
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("units of a scene");
        let ids = self.ids.take();
        let mut ids = ids.unwrap_or_else(|| SceneTarget::new(&gpu, Phase::Ids));
        ids.fit(&gpu, view.size)?;
        let style = style.without_hiding();
        self.write(view, &style);
        let textures = self.textures();
        let frame = Frame {
            view,
            style: &style,
            phase: Phase::Ids,
            scene: &self.view,
            placements: &self.seen_placements,
            textures: textures.as_ref(),
        };
        for layer in &mut self.layers {
            layer.prepare(&mut encoder, &frame)?;
        }
        let mut pass = ids.begin(&mut encoder, Go::Only, style.background(), None);
        draw_layers(&self.layers, &mut pass, Phase::Ids, Go::Only);
        drop(pass);
        gpu.submit(encoder);
        Ok(self.ids.insert(ids).image())
    }

    /// What of a glance's view each unit would refine, on its way; `None` where it has no view.
    ///
    /// # Errors
    /// The device binds no buffer for as many units.
    pub fn footprints(
        &mut self,
        glance: &Glance,
        style: &SceneStyle,
    ) -> Result<Option<FootprintsBack>, RenderError> {
        let Some(view) = glance.view.as_ref().map(small_view) else {
            return Ok(None);
        };
        let pass = match self.footprints.take() {
            Some(pass) => pass,
            None => FootprintPass::new(&self.gpu, self.refining_units)?,
        };
        let gpu = self.gpu.clone();
        let params = GazedParams::new(glance, &view);
        let back = pass.add_up(&gpu, self.ids(&view, style)?, &params);
        self.footprints = Some(pass);
        Ok(Some(back))
    }

    /// Records a picture of colours, in front of what is `under` the scene, if anything is.
    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &EyeView,
        style: &SceneStyle,
        under: Option<&wgpu::Texture>,
    ) -> Result<(), RenderError> {
        self.colours.fit(&self.gpu, view.size)?;
        let mut goes_twice = false;
        for layer in &mut self.layers {
            goes_twice |= layer.goes_twice(view.size, style)?;
        }
        let (style, goes): (_, &[Go]) = match goes_twice {
            true => (*style, &[Go::First, Go::Second]),
            false => (style.without_hiding(), &[Go::Only]),
        };
        self.write(view, &style);
        let textures = self.textures();
        let frame = Frame {
            view,
            style: &style,
            phase: Phase::Opaque,
            scene: &self.view,
            placements: &self.seen_placements,
            textures: textures.as_ref(),
        };
        for layer in &mut self.layers {
            layer.prepare(encoder, &frame)?;
        }
        let depths = self.colours.depth_view();
        for go in goes {
            let mut pass = self.colours.begin(encoder, *go, style.background(), under);
            draw_layers(&self.layers, &mut pass, Phase::Opaque, *go);
            drop(pass);
            for layer in self.layers.iter_mut().filter(|_| *go != Go::Second) {
                layer.take_depths(encoder, &frame, &depths);
            }
        }
        Ok(())
    }

    /// Writes to the GPU what all layers draw a view by.
    fn write(&self, view: &EyeView, style: &SceneStyle) {
        let coarsest = self.layers.iter().map(|layer| layer.coarsest()).max();
        let params = SceneParams::new(view, style, coarsest.unwrap_or_default());
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&params));
        let placements = self.placements.seen_by(view);
        let bytes = bytemuck::cast_slice(&placements);
        queue.write_buffer(&self.seen_placements, 0, bytes);
    }

    /// How textures are read, where a layer holds them.
    fn textures(&self) -> Option<Textures> {
        self.layers.iter().find_map(|layer| layer.textures())
    }
}

/// Draws all layers' part of a picture, phase by phase.
fn draw_layers(
    layers: &[Box<dyn KindLayer>],
    pass: &mut wgpu::RenderPass<'_>,
    phase: Phase,
    go: Go,
) {
    for phase in phase.all() {
        layers.iter().for_each(|layer| layer.draw(pass, *phase, go));
    }
}
