//! How does a view of a scene's units become a picture on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::compute::{Compute, Dispatch, record};
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::{PictureTarget, check_size};
use crate::gpu::readback::{PictureCopy, ReadBack};
#[cfg(not(target_arch = "wasm32"))]
use crate::image::RgbaImage;
use crate::importance::marks::UnitMarks;
use crate::meshes::hiding::Hiding;
use crate::meshes::lists::DrawList;
use crate::meshes::memory::UnitMemory;
use crate::meshes::pass::ClusterPass;
use crate::meshes::units::{ComingUnit, SceneUnits};
use crate::pages::{ComingPage, PageLayer};
use crate::points::layer::PointLayer;
use crate::points::units::ComingPoints;
use crate::scene::footprints::{FootprintPass, FootprintsBack, GazedParams, small_view};
use crate::scene::params::{Culling, PlacementParams, SceneParams, SceneStyle};
use crate::scene::phase::{Phase, UNITS_FORMAT};
use crate::scene::placements::Placements;
use crate::shaders;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::glance::Glance;
use foveal_core::view::eye_view::EyeView;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Most workgroups along one side of a dispatch.
const MOST_WORKGROUPS: u32 = 65_535;
/// Fewer clusters are drawn sooner than it is found out which are hidden.
const LEAST_HIDING: u32 = 4096;

/// The units of a scene on the GPU, and the pictures that are drawn of them.
///
/// ```no_run
/// # use foveal_core::content::scene::description::SceneDescription;
/// # use foveal_core::view::eye_view::EyeView;
/// # use foveal_render::{ComingUnit, Gpu, SceneLayer, SceneStyle};
/// # fn show(about: &SceneDescription, root: &ComingUnit<'_>, view: &EyeView)
/// # -> Result<(), foveal_render::RenderError> {
/// let gpu = Gpu::open_blocking()?;
/// let mut layer = SceneLayer::new(&gpu, &about.objects, &about.textures, 256 << 20)?;
/// layer.upload(root)?;
/// let image = layer.picture(view, &SceneStyle::default())?;
/// # Ok(()) }
/// ```
pub struct SceneLayer {
    gpu: Gpu,
    units: SceneUnits,
    memory: UnitMemory,
    pages: PageLayer,
    placements: Placements,
    /// Clusters that are seen from outside, and from both sides.
    lists: [DrawList; 2],
    is_two_sided: Vec<bool>,
    /// Whether units came or went since the lists were made.
    is_stale: bool,
    triangles: u64,
    view: wgpu::Buffer,
    seen_placements: wgpu::Buffer,
    cull: Compute,
    hiding: Hiding,
    colours: ClusterPass,
    refiners: Option<ClusterPass>,
    footprints: Option<FootprintPass>,
    output: PictureTarget,
    unit_image: Option<wgpu::Texture>,
    /// What units are worth, where pictures are to show that.
    marks: Option<UnitMarks>,
    /// Where there are clouds of points.
    clouds: Option<PointLayer>,
}

impl SceneLayer {
    /// No unit of these objects and textures; units may take `most_bytes` of GPU memory, as
    /// [`unit_bytes`](crate::meshes::unit_bytes) counts them. What lies between units may take an
    /// eighth more, and tables some bytes for each triangle.
    ///
    /// # Errors
    /// The objects stand in more places than the device binds.
    pub fn new(
        gpu: &Gpu,
        objects: &[SceneObject],
        textures: &[SceneTexture],
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let pages = PageLayer::new(gpu, textures, objects, most_bytes)?;
        let placements = Placements::new(objects, pages.table());
        let bytes = placements.count() * size_of::<PlacementParams>();
        let view_bytes = size_of::<SceneParams>() as u64;
        let has_clouds = objects.iter().any(|it| it.points.is_some());
        let clouds = has_clouds.then(|| PointLayer::new(gpu, objects));
        let uniform = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_SRC;
        Ok(Self {
            gpu: gpu.clone(),
            units: SceneUnits::new(objects.len()),
            memory: UnitMemory::new(gpu, most_bytes)?,
            pages,
            seen_placements: storage(gpu, "placements of objects", bytes as u64)?,
            placements,
            lists: [DrawList::new(gpu)?, DrawList::new(gpu)?],
            is_two_sided: objects.iter().map(|it| it.two_sided).collect(),
            is_stale: false,
            triangles: 0,
            view: written(gpu, "view of a scene", view_bytes, uniform),
            cull: Compute::new(gpu, &shaders::cull_clusters()),
            hiding: Hiding::new(gpu, bytes as u64)?,
            colours: ClusterPass::new(gpu, Phase::Opaque),
            refiners: None,
            footprints: None,
            output: PictureTarget::new(gpu, [1, 1]),
            unit_image: None,
            marks: None,
            clouds: clouds.transpose()?,
        })
    }

    /// Adds a unit after its prerequisites; one that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload(&mut self, coming: &ComingUnit<'_>) -> Result<(), RenderError> {
        if !self.units.insert(coming)? {
            return Ok(());
        }
        self.share();
        let mut placed = self.memory.insert(&self.units, coming.unit);
        if let (Err(_), Some(clouds)) = (&placed, &mut self.clouds) {
            clouds.pack()?;
            self.share();
            placed = self.memory.insert(&self.units, coming.unit);
        }
        if let Err(error) = placed {
            self.units.remove(coming.unit);
            return Err(error);
        }
        self.is_stale = true;
        Ok(())
    }

    /// Gives meshes what clouds use of the memory.
    fn share(&mut self) {
        let clouds = self.clouds.as_ref().map(PointLayer::point_bytes);
        self.memory.share(clouds.unwrap_or_default());
    }

    /// Adds a unit of a cloud after the unit that it refines; one that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there or into the GPU's memory: nothing changed then.
    pub fn upload_points(&mut self, coming: &ComingPoints<'_>) -> Result<(), RenderError> {
        let Some(clouds) = &mut self.clouds else {
            return Err(RenderError::OtherKind);
        };
        let [most, all] = self.memory.most();
        let most = most.saturating_sub(self.memory.used_bytes());
        let pages = self.pages.bytes();
        let room = all.saturating_sub(self.memory.bytes() + pages);
        match clouds.upload(coming, [most, room]) {
            // Meshes keep more than they use.
            Err(RenderError::NoRoom { bytes, .. }) if bytes <= most => {
                self.memory.share([bytes, 2 * bytes]);
                self.memory.pack(&self.units, 0)?;
                self.is_stale = true;
                let room = all.saturating_sub(self.memory.bytes() + pages);
                clouds.upload(coming, [most, room])
            }
            other => other,
        }
    }

    /// Adds a page of a texture after the page that it lies in; one that is there stays as it is.
    /// `false` where there is no room for it: the coarser page is shown.
    ///
    /// # Errors
    /// It does not fit to what is there: nothing changed then.
    pub fn upload_page(&mut self, coming: &ComingPage<'_>) -> Result<bool, RenderError> {
        self.share();
        let mut is_there = self.pages.upload(coming, self.memory.room_beside())?;
        if !is_there {
            self.memory.tighten(&self.units)?;
            is_there = self.pages.upload(coming, self.memory.room_beside())?;
        }
        self.memory.set_beside(self.pages.bytes());
        Ok(is_there)
    }

    /// Takes a unit away; what it replaced is drawn again.
    ///
    /// # Panics
    /// No other that is there may need it.
    pub fn remove(&mut self, unit: UnitId) {
        if self.units.remove(unit) {
            self.memory.remove(unit);
            self.is_stale = true;
        } else if let Some(clouds) = &mut self.clouds {
            clouds.remove(unit);
        }
    }

    /// Takes all units away but those that are wanted, what these need, and roots.
    pub fn retain(&mut self, wanted: &HashSet<UnitId>) {
        if let Some(clouds) = &mut self.clouds {
            clouds.retain(wanted);
        }
        for unit in self.units.retain(wanted) {
            self.memory.remove(unit);
            self.is_stale = true;
        }
        self.pages.retain(wanted);
        self.memory.set_beside(self.pages.bytes());
    }

    /// From now on the new vertices of these units have gone so much of their way from the coarse
    /// surface, 0 to 1, and all others are in their places. Writes what moves to the GPU: sixteen
    /// bytes a vertex.
    pub fn morph(&mut self, shares: &BTreeMap<UnitId, f64>) {
        let moved = self.units.morph(shares);
        self.memory.rewrite(&self.units, &moved);
    }

    /// From now on these are the units that would refine clusters, each by its unit and its number
    /// in it: what [`Self::ids`] shows. Only those of units that are there or will be are needed.
    pub fn set_refiners(&mut self, refiners: HashMap<(UnitId, u8), UnitId>) {
        if let Some(clouds) = &mut self.clouds {
            clouds.set_refiners(refiners.clone());
        }
        self.memory.set_refiners(refiners);
        self.footprints = None;
    }

    /// Bytes of GPU memory of units, in use or kept for more, and of tables.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let lists: u64 = self.lists.iter().map(DrawList::bytes).sum();
        let clouds = self.clouds.as_ref().map_or(0, PointLayer::gpu_bytes);
        let tables = lists + self.seen_placements.size() + self.hiding.bytes();
        self.memory.bytes() + self.pages.bytes() + tables + clouds
    }

    /// Triangles of the clusters that the last picture was drawn of, also of those that cannot be
    /// seen, each where it stands.
    #[must_use]
    pub fn triangles_drawn(&self) -> u64 {
        self.triangles
    }

    /// Number of clusters that the last picture was drawn of: those that the picture before did not
    /// hide, and those that it did but this did not. Blocks.
    ///
    /// # Errors
    /// The device was lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn clusters_drawn(&self) -> Result<[u32; 2], RenderError> {
        let mut drawn = [0; 2];
        for list in &self.lists {
            for (sum, count) in drawn.iter_mut().zip(list.clusters_drawn(&self.gpu)?) {
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
        let gpu = self.gpu.clone();
        let mut encoder = gpu.encoder("scene");
        self.record(&mut encoder, view, style)?;
        gpu.submit(encoder);
        if let Some(marks) = self.marks.take() {
            let units = self.ids(view, style)?.clone();
            marks.paint(&gpu, &units, &self.output);
            self.marks = Some(marks);
        }
        Ok(&self.output.picture)
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
        let gpu = self.gpu.clone();
        self.draw(view, style)?;
        let mut encoder = gpu.encoder("scene to read");
        let copy = PictureCopy::record(&gpu, &mut encoder, &self.output.picture);
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

    /// An r32uint texture: for each pixel of `view` the unit that would refine the cluster that is
    /// drawn there, by its number; 4294967295 where none would, and where nothing stands. The next
    /// call reuses it.
    ///
    /// # Errors
    /// The picture is larger than the device draws.
    pub fn ids(
        &mut self,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<&wgpu::Texture, RenderError> {
        let gpu = self.gpu.clone();
        check_size(&gpu, view.size)?;
        let mut encoder = gpu.encoder("units of a scene");
        let style = &self.without_hiding(style);
        self.prepare(&mut encoder, view, style)?;
        let [width, height] = view.size.map(|side| side.max(1));
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let image = self.unit_image.take().filter(|it| it.size() == size);
        let image = image.unwrap_or_else(|| unit_image(&gpu, size));
        let pass = self.refiners.take();
        let mut pass = pass.unwrap_or_else(|| ClusterPass::new(&gpu, Phase::Ids));
        let bound = self.bind(&pass);
        if let Some(clouds) = &mut self.clouds {
            clouds.ready(Phase::Ids);
        }
        let target = (&image, style.background());
        let lists = listed(&self.lists, &bound);
        let beside = beside(self.clouds.as_ref(), Phase::Ids, &self.view);
        pass.record((&gpu, &mut encoder), target, (0, lists), beside);
        self.refiners = Some(pass);
        gpu.submit(encoder);
        Ok(self.unit_image.insert(image))
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
            None => FootprintPass::new(&self.gpu, self.memory.refining_units())?,
        };
        let gpu = self.gpu.clone();
        let params = GazedParams::new(glance, &view);
        let back = pass.add_up(&gpu, self.ids(&view, style)?, &params);
        self.footprints = Some(pass);
        Ok(Some(back))
    }

    fn record(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<(), RenderError> {
        self.output.fit(&self.gpu, view.size)?;
        let hides = style.culls.hidden && self.clusters() >= LEAST_HIDING;
        if hides {
            self.hiding.fit(&self.gpu, view.size)?;
        }
        let goes_twice = hides && self.hiding.is_there;
        let go_once = self.without_hiding(style);
        self.prepare(encoder, view, if goes_twice { style } else { &go_once })?;
        self.go(encoder, style, 0, goes_twice);
        if !hides {
            return Ok(());
        }
        if let Some(depths) = self.colours.depths() {
            self.hiding.record(&self.gpu, encoder, &depths);
        }
        let placements = &self.seen_placements;
        self.hiding.take(encoder, &self.view, placements);
        if goes_twice {
            self.lists.iter().for_each(|list| list.go_on(encoder));
            self.cull(encoder, 1);
            self.go(encoder, style, 1, false);
        }
        Ok(())
    }

    /// Records one of the goes of a picture; clouds are drawn in the last.
    fn go(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        style: &SceneStyle,
        go: usize,
        more_comes: bool,
    ) {
        let bound = self.bind(&self.colours);
        let lists = listed(&self.lists, &bound);
        let target = (&self.output.picture, style.background());
        let clouds = self.clouds.as_ref().filter(|_| !more_comes);
        let beside = beside(clouds, Phase::Opaque, &self.view);
        self.colours
            .record((&self.gpu, encoder), target, (go, lists), beside);
    }

    /// The style without leaving out what others hide.
    fn without_hiding(&self, style: &SceneStyle) -> SceneStyle {
        SceneStyle {
            culls: Culling {
                hidden: false,
                ..style.culls
            },
            ..*style
        }
    }

    /// Number of clusters that may be seen, each where it stands.
    fn clusters(&self) -> u32 {
        self.lists.iter().map(DrawList::count).sum()
    }

    /// Writes what a picture of `view` is drawn by, and records what finds the clusters in it.
    fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &EyeView,
        style: &SceneStyle,
    ) -> Result<(), RenderError> {
        if self.is_stale {
            self.fill_lists()?;
            self.is_stale = false;
        }
        self.pages.settle();
        let mut coarsest = self.units.coarsest();
        if let Some(clouds) = &mut self.clouds {
            coarsest = coarsest.max(clouds.coarsest());
            clouds.prepare(view, style)?;
        }
        let params = SceneParams::new(view, style, coarsest);
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&params));
        let placements = self.placements.seen_by(view);
        let bytes = bytemuck::cast_slice(&placements);
        queue.write_buffer(&self.seen_placements, 0, bytes);
        self.lists.iter().for_each(|list| list.begin(&self.gpu));
        self.cull(encoder, 0);
        Ok(())
    }

    /// Records what finds the clusters that a go draws.
    fn cull(&self, encoder: &mut wgpu::CommandEncoder, go: usize) {
        let lists = self.lists.iter().filter(|list| list.count() > 0);
        let dispatches: Vec<_> = lists.map(|list| self.culling(list, go)).collect();
        record(encoder, "cull_clusters", None, &dispatches);
    }

    /// Makes the lists of the clusters that are drawn of the units that are there.
    fn fill_lists(&mut self) -> Result<(), RenderError> {
        let mut clusters = [Vec::new(), Vec::new()];
        let mut counts = [0_u64; 2];
        for drawn in self.units.drawn() {
            let Some(block) = self.memory.block(drawn.unit, drawn.cluster) else {
                continue;
            };
            let object = drawn.note.object;
            let placements = self.placements.of(object);
            let triangles = drawn.placed.clusters[drawn.cluster].triangles.len();
            let list = usize::from(self.is_two_sided[usize::from(object)]);
            counts[list] += triangles as u64 * placements.len() as u64;
            clusters[list].extend(placements.map(|placement| [block, placement]));
        }
        for (k, list) in self.lists.iter_mut().enumerate() {
            list.fill(&self.gpu, &clusters[k], counts[k])?;
        }
        self.triangles = counts.iter().sum();
        Ok(())
    }

    /// The pass that finds the clusters of a list that a go draws.
    fn culling(&self, list: &DrawList, go: usize) -> Dispatch {
        let [_, words] = self.memory.buffers();
        let bindings = [
            (0, self.view.as_entire_binding()),
            (1, self.seen_placements.as_entire_binding()),
            (2, words.as_entire_binding()),
            (3, list.candidates()),
            (4, list.shown().as_entire_binding()),
            (5, list.arguments(go).as_entire_binding()),
            (6, list.corners().as_entire_binding()),
            (7, self.hiding.view.as_entire_binding()),
            (8, self.hiding.placements.as_entire_binding()),
            (9, self.hiding.depths()),
        ];
        let across = list.count().min(MOST_WORKGROUPS);
        let size = [across, list.count().div_ceil(across)];
        self.cull.over(&self.gpu, size, [1; 2], &bindings)
    }

    /// Binds what each list is drawn with.
    fn bind(&self, pass: &ClusterPass) -> [wgpu::BindGroup; 2] {
        let [vertices, words] = self.memory.buffers();
        let buffers = [&self.view, &self.seen_placements, words, vertices];
        [0, 1].map(|k| pass.bind(&self.gpu, buffers, self.lists[k].shown(), &self.pages))
    }
}

/// What draws clouds into a pass, where there are any.
fn beside<'a>(
    clouds: Option<&'a PointLayer>,
    phase: Phase,
    view: &'a wgpu::Buffer,
) -> impl FnOnce(&mut wgpu::RenderPass<'_>) + use<'a> {
    move |pass| {
        if let Some(clouds) = clouds {
            clouds.draw(pass, phase, view);
        }
    }
}

/// Each list with what it is drawn with.
fn listed<'a>(
    [outside, both]: &'a [DrawList; 2],
    [of_outside, of_both]: &'a [wgpu::BindGroup; 2],
) -> [(&'a DrawList, &'a wgpu::BindGroup); 2] {
    [(outside, of_outside), (both, of_both)]
}

fn unit_image(gpu: &Gpu, size: wgpu::Extent3d) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("units of a scene"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: UNITS_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}
