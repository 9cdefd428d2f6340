//! Does the store keep what is wanted, and show only what belongs together?

use crate::common::*;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use foveal_render::twin::TwinTiles;
use foveal_render::{Gpu, HalvedBy, RenderError, Renderer};

fn scene() -> Scene {
    let grid = TileGrid::new(flat([512, 256]), Cut::Tile(32), 3, 2).unwrap();
    Scene::new(grid, FULL, waves)
}

#[test]
fn tiles_of_another_frame_are_counted_and_not_shown() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let fine = scene.finest();
    let mut renderer = scene.on_gpu(&gpu, &fine);
    let mut twin = scene.in_memory(&fine);
    assert_eq!(renderer.tiles().wrong_frame_tiles(), 0);
    assert_eq!(twin.wrong_frame_tiles(), 0);
    renderer.tiles().begin_frame(2);
    twin.begin_frame(2);
    assert_eq!(renderer.tiles().wrong_frame_tiles(), fine.len() + 1);
    assert_eq!(twin.wrong_frame_tiles(), fine.len() + 1);
    let empty = TwinTiles::new(&scene.grid, FULL);
    assert_eq!(empty.wrong_frame_tiles(), 1);
    assert!(renderer.tiles().level_map().iter().all(|&level| level == 2));
    renderer
        .tiles()
        .upload(fine[5], 2, &scene.tile(fine[5]))
        .unwrap();
    assert_eq!(renderer.tiles().wrong_frame_tiles(), fine.len());
    assert_eq!(renderer.tiles().level_map()[5], 0);
    let view = EyeView::filling(&scene.grid.surface, [512, 256]);
    let mut alone = scene.on_gpu(&gpu, &[fine[5]]);
    let expected = alone.reconstruct(&view).unwrap();
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
}

#[test]
fn exactly_the_wanted_tiles_stay() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let fine = scene.finest();
    let mut renderer = scene.on_gpu(&gpu, &fine[..40]);
    renderer.tiles().retain(&fine[30..50]);
    assert_eq!(renderer.tiles().resident().len(), 10);
    for &tile in &fine[30..50] {
        renderer.tiles().upload(tile, 1, &scene.tile(tile)).unwrap();
    }
    let mut wanted = fine[30..50].to_vec();
    wanted.sort_unstable();
    assert_eq!(renderer.tiles().resident(), wanted);
    let view = EyeView::filling(&scene.grid.surface, [512, 256]);
    let mut fresh = scene.on_gpu(&gpu, &wanted);
    assert_eq!(
        renderer.reconstruct(&view).unwrap(),
        fresh.reconstruct(&view).unwrap()
    );
}

#[test]
fn tiles_that_stay_are_not_shown_until_they_are_shown_again() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let fine = scene.finest();
    let mut renderer = scene.on_gpu(&gpu, &fine);
    let mut twin = scene.in_memory(&fine);
    let view = EyeView::filling(&scene.grid.surface, [512, 256]);
    let (all, all_levels) = (
        renderer.reconstruct(&view).unwrap(),
        twin.level_map().to_vec(),
    );
    renderer.tiles().keep(&fine[..1], &fine[1..]);
    twin.keep(&fine[..1], &fine[1..]);
    let mut alone = scene.on_gpu(&gpu, &fine[..1]);
    let expected = alone.reconstruct(&view).unwrap();
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
    assert_eq!(renderer.tiles().level_map(), twin.level_map());
    assert_eq!(twin.level_map(), scene.in_memory(&fine[..1]).level_map());
    for tile in &fine[1..] {
        assert!(renderer.tiles().show(*tile) && twin.show(*tile));
    }
    assert_eq!(renderer.reconstruct(&view).unwrap(), all);
    assert_eq!(twin.level_map(), all_levels);
}

#[test]
fn tiles_that_stay_give_way_before_the_atlas_grows() {
    let gpu = Gpu::open_blocking().unwrap();
    let grid = TileGrid::new(flat([4096, 2048]), Cut::Tile(512), 3, 2).unwrap();
    let mut renderer = Renderer::new(&gpu, &grid, FULL, 2).unwrap();
    let tiles = renderer.tiles();
    tiles.begin_frame(1);
    let bytes = tiles.gpu_bytes();
    let fine: Vec<Tile> = grid.tiles_of(0).take(4).collect();
    let picture = Picture::filled(512, 512, [90, 128, 128]);
    // The coarsest level takes two of the first four slots.
    for tile in &fine[..2] {
        tiles.upload(*tile, 1, &picture).unwrap();
    }
    tiles.keep(&[], &fine[..2]);
    tiles.spare(&fine[1..2]);
    tiles.upload(fine[2], 1, &picture).unwrap();
    assert_eq!(tiles.take_evicted(), [(fine[0], 1)]);
    assert!(tiles.show(fine[1]) && !tiles.show(fine[0]));
    assert_eq!(tiles.gpu_bytes(), bytes);
    tiles.upload(fine[3], 1, &picture).unwrap();
    assert!(tiles.gpu_bytes() > bytes);
}

#[test]
fn the_atlas_grows_to_its_bound_and_then_reuses_the_oldest_slot() {
    let gpu = Gpu::open_blocking().unwrap();
    let grid = TileGrid::new(flat([4096, 2048]), Cut::Tile(512), 3, 2).unwrap();
    let picture = |tile: Tile| {
        let [w, h] = grid.tile_size(tile);
        Picture::filled(w, h, [tile.x as u8 * 20 + tile.y as u8, 128, 128])
    };
    let mut renderer = Renderer::new(&gpu, &grid, FULL, 2).unwrap();
    renderer.tiles().halve_by(HalvedBy::Cpu);
    renderer.tiles().begin_frame(1);
    let before = renderer.tiles().gpu_bytes();
    let layer = 1024 * 1024 * 3 / 2 * 5 / 4;
    let tables = 8 * 4 * 4;
    assert!(before.abs_diff(layer + tables) < 200, "{before}");
    for tile in grid.tiles_of(2).chain(grid.tiles_of(0).take(12)) {
        renderer.tiles().upload(tile, 1, &picture(tile)).unwrap();
    }
    assert_eq!(renderer.tiles().gpu_bytes(), before + layer);
    // The coarsest level takes two of the first four slots.
    let expected: Vec<Tile> = (6..12).map(|rank| grid.tile_at(0, rank)).collect();
    let mut resident = renderer.tiles().resident();
    resident.sort_by_key(|&tile| grid.rank(tile));
    assert_eq!(resident, expected);
    for tile in expected {
        let middle = grid.origin(tile).map(|o| f64::from(o) + 256.0);
        let view = window(&grid.surface, middle, [2, 2], 1.0);
        let shown = renderer.reconstruct(&view).unwrap().pixel([0, 0]);
        assert_eq!(shown[0], tile.x as u8 * 20 + tile.y as u8, "{tile:?}");
    }
}

#[test]
fn a_slot_that_changes_hands_before_a_draw_has_the_averages_of_its_last_tile() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let fine = scene.finest();
    // Averages alone are shown, of the last tile that had the slot.
    let view = EyeView::filling(&scene.grid.surface, [256, 128]);
    let mut renderer = scene.halved_by(HalvedBy::Gpu, &gpu, &fine[..20]);
    for range in [10..40, 30..128] {
        renderer.tiles().retain(&fine[range.clone()]);
        for &tile in &fine[range] {
            renderer.tiles().upload(tile, 1, &scene.tile(tile)).unwrap();
        }
    }
    let mut fresh = scene.halved_by(HalvedBy::Cpu, &gpu, &fine[30..]);
    let expected = fresh.reconstruct(&view).unwrap();
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
}

#[test]
fn an_atlas_that_grows_before_a_draw_keeps_what_was_halved_and_halves_the_rest() {
    let gpu = Gpu::open_blocking().unwrap();
    let grid = TileGrid::new(flat([1536, 768]), Cut::Tile(256), 4, 2).unwrap();
    let scene = Scene::new(grid, LEFT, waves);
    let fine = scene.finest();
    let view = EyeView::filling(&grid.surface, [384, 192]);
    let mut renderer = scene.halved_by(HalvedBy::Gpu, &gpu, &fine[..5]);
    renderer.reconstruct(&view).unwrap();
    let bytes = renderer.tiles().gpu_bytes();
    for (n, &tile) in fine[5..].iter().enumerate() {
        renderer.tiles().upload(tile, 1, &scene.tile(tile)).unwrap();
        if n == 3 {
            renderer.tiles().settle().unwrap();
        }
    }
    assert!(renderer.tiles().gpu_bytes() > bytes);
    let mut fresh = scene.halved_by(HalvedBy::Cpu, &gpu, &fine);
    let expected = fresh.reconstruct(&view).unwrap();
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
}

#[test]
fn a_picture_that_is_too_large_leaves_tiles_to_be_halved_for_the_next() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let fine = scene.finest();
    let mut renderer = scene.halved_by(HalvedBy::Gpu, &gpu, &fine);
    let most = gpu.device.limits().max_texture_dimension_2d;
    let large = EyeView::filling(&scene.grid.surface, [most + 1, 8]);
    assert!(renderer.draw(&large, None).is_err());
    let view = EyeView::filling(&scene.grid.surface, [256, 128]);
    let mut fresh = scene.halved_by(HalvedBy::Cpu, &gpu, &fine);
    let expected = fresh.reconstruct(&view).unwrap();
    assert_eq!(renderer.reconstruct(&view).unwrap(), expected);
}

#[test]
fn a_device_that_is_lost_before_tiles_are_halved_is_reported_and_nothing_panics() {
    let scene = scene();
    let tile = scene.finest()[3];
    let view = EyeView::filling(&scene.grid.surface, [256, 128]);
    for by in [HalvedBy::Cpu, HalvedBy::Gpu] {
        let gpu = Gpu::open_blocking().unwrap();
        let mut renderer = scene.halved_by(by, &gpu, &scene.finest());
        let (lost, reported) = std::sync::mpsc::channel();
        let tell = move |_, _| lost.send(()).unwrap();
        gpu.device.set_device_lost_callback(tell);
        gpu.device.destroy();
        assert!(renderer.draw(&view, None).is_ok(), "{by:?}");
        renderer.tiles().upload(tile, 1, &scene.tile(tile)).unwrap();
        assert!(renderer.draw(&view, None).is_ok(), "{by:?}");
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        assert!(reported.try_recv().is_ok(), "{by:?}");
    }
}

#[test]
fn a_tile_of_the_wrong_size_or_place_is_refused() {
    let gpu = Gpu::open_blocking().unwrap();
    let scene = scene();
    let mut renderer = scene.on_gpu(&gpu, &[]);
    let tile = scene.grid.tile_at(0, 3);
    let small = Picture::filled(31, 32, [0; 3]);
    let refused = renderer.tiles().upload(tile, 1, &small);
    assert!(matches!(refused, Err(RenderError::TileSize { .. })));
    let nowhere = Tile { x: 99, ..tile };
    let refused = renderer.tiles().upload(nowhere, 1, &small);
    assert!(matches!(refused, Err(RenderError::NoSuchTile(_))));
}

#[test]
fn a_missing_adapter_is_explained_with_what_to_install() {
    let said = RenderError::NoAdapter("none".to_owned()).to_string();
    assert!(said.contains("mesa-vulkan-drivers libvulkan1"), "{said}");
}
