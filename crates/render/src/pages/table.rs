//! Which page shows each part of a texture?
//!
//! The table is words that shaders read: a head of each texture, the textures of each object, and
//! for each level of a texture an entry a page, which says where the finest page lies that is there
//! and shows that part, and of which level it is.

use crate::error::RenderError;
use crate::idle::IdleUnits;
use crate::pages::tail::{place_in_tail, tail_of};
use crate::scene::placements::OnTextures;
use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{BORDER, PagePlace, TextureShape};
use foveal_core::content::images::wrap::Wrap;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use std::collections::{BTreeMap, HashSet};
use std::ops::Range;

/// Words of a texture's head: columns, rows, levels and wraps, cutoff, mean colour, one unused,
/// then where the entries of each level begin.
pub(crate) const HEAD_WORDS: usize = 24;
/// Where in a head the levels begin.
const FIRST_LEVEL: usize = 8;
/// Words of an entry: column and row of the first texel, then layer and level.
const ENTRY_WORDS: usize = 2;
/// Stands for no page.
pub(crate) const NO_PAGE: u32 = u32::MAX;

/// Where a page lies: column and row of its first texel, its border included, and the layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct PageSlot {
    pub(crate) at: [u16; 2],
    pub(crate) layer: u16,
}

/// A page that is there.
#[derive(Clone, Debug)]
struct PageNote {
    texture: u16,
    page: PagePlace,
    /// Where it lies; of a root, then, where the levels made of it lie.
    slots: Vec<PageSlot>,
    needs: Vec<UnitId>,
    /// How many pages that are there need it.
    dependents: u32,
}

/// The pages that are there.
pub(crate) struct PageTable {
    textures: Vec<SceneTexture>,
    notes: BTreeMap<UnitId, PageNote>,
    words: Vec<u32>,
    /// Where the list of textures of each object begins.
    lists: Vec<u32>,
    /// Words that changed since they were taken.
    changed: Range<usize>,
    /// Which are not shown and stay, and these.
    pub(crate) idle: IdleUnits<UnitId>,
    hidden: BTreeMap<UnitId, PageNote>,
}

impl PageTable {
    /// No page of these textures, which these objects have.
    pub(crate) fn new(textures: &[SceneTexture], objects: &[SceneObject]) -> Self {
        let mut words = vec![0; HEAD_WORDS * textures.len()];
        let mut lists = Vec::with_capacity(objects.len());
        for object in objects {
            lists.push(words.len() as u32);
            let of_object = object.texturing.iter().flat_map(|it| &it.textures);
            words.extend(of_object.map(|it| u32::from(*it)));
        }
        for (number, texture) in textures.iter().enumerate() {
            let head = number * HEAD_WORDS;
            let shape = shape_of(texture);
            words[head..head + FIRST_LEVEL].copy_from_slice(&head_words(texture));
            for level in 0..shape.levels() {
                words[head + FIRST_LEVEL + usize::from(level)] = words.len() as u32;
                let pages = shape.pages(level).map(|it| it as usize);
                words.extend(vec![NO_PAGE; ENTRY_WORDS * pages[0] * pages[1]]);
            }
        }
        Self {
            textures: textures.to_vec(),
            notes: BTreeMap::new(),
            changed: 0..words.len(),
            words,
            lists,
            idle: IdleUnits::default(),
            hidden: BTreeMap::new(),
        }
    }

    /// What shaders read; never empty.
    pub(crate) fn words(&self) -> &[u32] {
        if self.words.is_empty() {
            &[0; 2]
        } else {
            &self.words
        }
    }

    /// Which words changed since this was last asked.
    pub(crate) fn take_changed(&mut self) -> Range<usize> {
        std::mem::replace(&mut self.changed, self.words.len()..0)
    }

    /// How the vertices of an object, the one of this number, lie on textures.
    pub(crate) fn place_of(&self, number: usize, object: &SceneObject) -> OnTextures {
        OnTextures {
            uv_from_grid: self.uv_from_grid(object),
            textures: self.lists[number],
        }
    }

    /// How places on the grid of an object's textures become those on textures. What repeats begins
    /// near 0, where single precision holds more.
    fn uv_from_grid(&self, object: &SceneObject) -> [f32; 4] {
        let Some(texturing) = &object.texturing else {
            return [0.0; 4];
        };
        let mut textures = texturing.textures.iter().filter_map(|it| self.texture(*it));
        let clamps = textures.any(|it| it.wrap.contains(&Wrap::Clamp));
        let [u, v] = texturing.origin.map(|it| match clamps {
            true => it,
            // Mirrors repeat every second time.
            false => it.rem_euclid(2.0),
        });
        let [across, along] = texturing.step;
        [u, v, across, along].map(|it| it as f32)
    }

    /// A texture.
    pub(crate) fn texture(&self, number: u16) -> Option<&SceneTexture> {
        self.textures.get(usize::from(number))
    }

    /// Whether a page is there.
    pub(crate) fn is_there(&self, unit: UnitId) -> bool {
        self.notes.contains_key(&unit)
    }

    /// The texture of a page, which must fit to what is there.
    fn check(
        &self,
        unit: UnitId,
        needs: &[UnitId],
        (texture, page): (u16, PagePlace),
    ) -> Result<&SceneTexture, RenderError> {
        let misfit = |what: &str, found: String, expected: &str| {
            Err(RenderError::Misfit {
                what: format!("unit {}, {what}", unit.0),
                expected: expected.to_owned(),
                found,
            })
        };
        let Some(of) = self.texture(texture) else {
            return misfit("texture", texture.to_string(), "one of the scene's");
        };
        let shape = shape_of(of);
        if shape.page_size(page).is_none() {
            return misfit("page", format!("{page:?}"), "one of its texture's");
        }
        let is_coarser = |need: &UnitId| {
            let note = self.notes.get(need);
            note.is_some_and(|it| (it.texture, it.page) == (texture, page.coarser()))
        };
        let is_root = page.level == shape.root();
        match needs {
            [] if is_root => Ok(of),
            [need] if !is_root && is_coarser(need) => Ok(of),
            _ => misfit(
                "prerequisites",
                format!("{needs:?}"),
                "the page that it lies in",
            ),
        }
    }

    /// The pictures of a page that fits to what is there: its own, and of a root the slot of the
    /// levels that are made of it.
    pub(crate) fn pictures_of(
        &self,
        unit: UnitId,
        needs: &[UnitId],
        payload: &ImagePage,
    ) -> Result<Vec<TexturePicture>, RenderError> {
        let texture = self.check(unit, needs, (payload.texture, payload.page))?;
        let shape = shape_of(texture);
        let has_tail = needs.is_empty() && shape.levels() > shape.root() + 1;
        let tail = has_tail.then(|| tail_of(&payload.picture, &shape, texture.wrap));
        Ok(std::iter::once(payload.picture.clone())
            .chain(tail)
            .collect())
    }

    /// Adds a page that [`Self::check`] accepts, and where it lies.
    pub(crate) fn insert(
        &mut self,
        unit: UnitId,
        needs: &[UnitId],
        (texture, page): (u16, PagePlace),
        slots: Vec<PageSlot>,
    ) {
        let note = PageNote {
            texture,
            page,
            slots,
            needs: needs.to_vec(),
            dependents: 0,
        };
        self.put(unit, note);
    }

    fn put(&mut self, unit: UnitId, note: PageNote) {
        for need in &note.needs {
            if let Some(coarser) = self.notes.get_mut(need) {
                coarser.dependents += 1;
            }
        }
        self.show(&note, None);
        self.notes.insert(unit, note);
    }

    /// Shows only pages that are wanted, what these need, and roots. Of the others those that are
    /// `staying` are kept, first what is to stay longest, each after those that it needs. Returns
    /// the places that are free now.
    pub(crate) fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) -> Vec<PageSlot> {
        let mut free = Vec::new();
        let stay: HashSet<UnitId> = staying.iter().copied().collect();
        let there: Vec<UnitId> = self.notes.keys().rev().copied().collect();
        for unit in there {
            // Those that need it have higher numbers: they are gone by now or stay.
            let note = &self.notes[&unit];
            if note.dependents > 0 || note.needs.is_empty() || wanted.contains(&unit) {
                continue;
            }
            let removed = self.remove(unit);
            match stay.contains(&unit) {
                true => self.hidden.extend(removed.map(|note| (unit, note))),
                false => free.extend(removed.into_iter().flat_map(|it| it.slots)),
            }
        }
        let leave = self.hidden.keys().filter(|unit| !stay.contains(*unit));
        for unit in leave.copied().collect::<Vec<_>>() {
            let gone = self.hidden.remove(&unit);
            free.extend(gone.into_iter().flat_map(|it| it.slots));
        }
        let staying = staying.iter().copied();
        let order = staying.filter(|unit| self.hidden.contains_key(unit));
        self.idle.set(order.collect());
        free
    }

    /// Shows a page again that stayed; `false` where it did not.
    pub(crate) fn show_again(&mut self, unit: UnitId) -> bool {
        let Some(note) = self.hidden.remove(&unit) else {
            return false;
        };
        self.idle.remove(unit);
        self.put(unit, note);
        true
    }

    /// The places of the next page that stayed and gives way; `None` where there is none.
    pub(crate) fn give_way(&mut self) -> Option<Vec<PageSlot>> {
        let unit = self.idle.give_way()?;
        Some(self.hidden.remove(&unit)?.slots)
    }

    /// From now on pages lie elsewhere, each at the next of these places, in order.
    pub(crate) fn move_to(&mut self, mut places: impl Iterator<Item = PageSlot>) {
        for note in self.notes.values_mut().chain(self.hidden.values_mut()) {
            let slots = note.slots.iter_mut().zip(&mut places);
            slots.for_each(|(slot, place)| *slot = place);
        }
        // Coarser pages have lower numbers: each shows over those before it.
        let notes: Vec<PageNote> = self.notes.values().cloned().collect();
        for texture in 0..self.textures.len() {
            self.forget_entries(texture);
        }
        notes.iter().for_each(|note| self.show(note, None));
    }

    /// Nothing shows any part of a texture.
    fn forget_entries(&mut self, texture: usize) {
        let shape = shape_of(&self.textures[texture]);
        for level in 0..shape.levels() {
            let first = self.words[texture * HEAD_WORDS + FIRST_LEVEL + usize::from(level)];
            let [columns, rows] = shape.pages(level);
            for page in 0..(columns * rows) as usize {
                self.write(first as usize + ENTRY_WORDS * page, [NO_PAGE; 2]);
            }
        }
    }

    /// Where all pages lie, in order.
    pub(crate) fn slots(&self) -> impl Iterator<Item = PageSlot> {
        let notes = self.notes.values().chain(self.hidden.values());
        notes.flat_map(|note| note.slots.iter().copied())
    }

    fn remove(&mut self, unit: UnitId) -> Option<PageNote> {
        let note = self.notes.remove(&unit)?;
        for need in &note.needs {
            if let Some(coarser) = self.notes.get_mut(need) {
                coarser.dependents -= 1;
            }
        }
        let coarser = note
            .needs
            .first()
            .and_then(|it| self.notes.get(it))
            .cloned();
        if let Some(coarser) = coarser {
            self.show(&coarser, Some((note.page, entry_of(&note))));
        }
        Some(note)
    }

    /// From now on a page shows its part where coarser ones or none did; or only where an entry was
    /// so far, in the part of that page.
    fn show(&mut self, note: &PageNote, instead: Option<(PagePlace, [u32; 2])>) {
        let shape = shape_of(&self.textures[usize::from(note.texture)]);
        let head = usize::from(note.texture) * HEAD_WORDS;
        let own = entry_of(note);
        let part = instead.map_or(note.page, |(page, _)| page);
        for level in 0..=part.level {
            let pages = shape.pages(level).map(|it| it as usize);
            let span = 1_usize << (part.level - level);
            let along = |k: usize| {
                let first = usize::from(part.place[k]) * span;
                first..(first + span).min(pages[k])
            };
            let first = self.words[head + FIRST_LEVEL + usize::from(level)] as usize;
            for row in along(1) {
                for column in along(0) {
                    let at = first + ENTRY_WORDS * (row * pages[0] + column);
                    let before = [self.words[at], self.words[at + 1]];
                    let is_replaced = match instead {
                        Some((_, entry)) => before == entry,
                        None => level_of(before) > level_of(own),
                    };
                    if is_replaced {
                        self.write(at, own);
                    }
                }
            }
        }
        if let ([_, tail], None) = (&note.slots[..], instead) {
            let tail = *tail;
            for below in 1..shape.levels() - shape.root() {
                let level = shape.root() + below;
                let at = self.words[head + FIRST_LEVEL + usize::from(level)] as usize;
                self.write(at, entry(tail, place_in_tail(below), level));
            }
        }
    }

    fn write(&mut self, at: usize, entry: [u32; 2]) {
        self.words[at..at + ENTRY_WORDS].copy_from_slice(&entry);
        let Range { start, end } = self.changed;
        self.changed = start.min(at)..end.max(at + ENTRY_WORDS);
    }
}

pub(crate) fn shape_of(texture: &SceneTexture) -> TextureShape {
    TextureShape { size: texture.size }
}

/// The words of a head before its levels.
fn head_words(texture: &SceneTexture) -> [u32; FIRST_LEVEL] {
    let wrap = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    });
    let levels = u32::from(shape_of(texture).levels()) | wrap[0] << 8 | wrap[1] << 16;
    let [columns, rows] = texture.size;
    let [r, g, b] = texture.colour.map(f32::to_bits);
    let cutoff = texture.cutoff.unwrap_or(0.0).to_bits();
    [columns, rows, levels, cutoff, r, g, b, 0]
}

fn entry_of(note: &PageNote) -> [u32; 2] {
    entry(note.slots[0], [BORDER; 2], note.page.level)
}

fn entry(slot: PageSlot, inside: [u32; 2], level: u8) -> [u32; 2] {
    let [x, y] = [0, 1].map(|k| u32::from(slot.at[k]) + inside[k]);
    [x | y << 16, u32::from(slot.layer) | u32::from(level) << 16]
}

fn level_of([_, word]: [u32; 2]) -> u32 {
    word >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(size: [u32; 2]) -> SceneTexture {
        SceneTexture {
            name: String::new(),
            size,
            wrap: [Wrap::Repeat; 2],
            colour: [0.5; 3],
            cutoff: None,
        }
    }

    fn slot(layer: u16) -> Vec<PageSlot> {
        vec![PageSlot { at: [0; 2], layer }]
    }

    /// Layer and level of the entry of a page of level 0.
    fn shown(table: &PageTable, column: usize) -> [u32; 2] {
        let at = table.words[FIRST_LEVEL] as usize + ENTRY_WORDS * column + 1;
        [table.words[at] & 0xffff, table.words[at] >> 16]
    }

    #[test]
    fn each_part_shows_the_finest_page_that_is_there_until_it_goes() {
        let mut table = PageTable::new(&[texture([1000, 100])], &[]);
        let page = |level, column| {
            (
                0,
                PagePlace {
                    level,
                    place: [column, 0],
                },
            )
        };
        let [root, coarse, fine] = [0, 1, 3].map(UnitId);
        assert_eq!(shown(&table, 2), [0xffff; 2]);
        let needs_root = table.check(coarse, &[root], page(1, 1));
        assert!(needs_root.is_err(), "its root is not there");
        table.insert(root, &[], page(2, 0), slot(7));
        assert!(table.check(coarse, &[root], page(1, 1)).is_ok());
        table.insert(coarse, &[root], page(1, 1), slot(8));
        table.insert(fine, &[coarse], page(0, 2), slot(9));
        let all = |table: &PageTable| [0, 1, 2, 3].map(|column| shown(table, column));
        assert_eq!(all(&table), [[7, 2], [7, 2], [9, 0], [8, 1]]);
        let wanted = HashSet::from([fine]);
        assert_eq!(table.keep(&wanted, &[]), []);
        let before = table.words.clone();
        assert_eq!(table.keep(&HashSet::new(), &[coarse, fine]), []);
        assert_eq!(all(&table), [[7, 2]; 4]);
        assert!([coarse, fine].map(|unit| table.show_again(unit)) == [true; 2]);
        assert_eq!(table.words, before);
        assert_eq!(table.keep(&HashSet::new(), &[]).len(), 2);
        assert_eq!(all(&table), [[7, 2]; 4]);
    }

    #[test]
    fn what_is_moved_is_shown_where_it_lies_now() {
        let mut table = PageTable::new(&[texture([512, 512])], &[]);
        let page = |level, place| (0, PagePlace { level, place });
        let [root, fine] = [0, 4].map(UnitId);
        table.insert(root, &[], page(1, [0, 0]), [slot(7), slot(9)].concat());
        table.insert(fine, &[root], page(0, [1, 0]), slot(8));
        let layers: Vec<u16> = table.slots().map(|it| it.layer).collect();
        assert_eq!(layers, [7, 9, 8]);
        table.move_to((0..3).flat_map(slot));
        assert_eq!([0, 1].map(|column| shown(&table, column)), [[0, 1], [2, 0]]);
    }
}
