//! Which numbers does a glTF accessor show?

use std::cell::RefCell;
use std::collections::HashSet;

use super::super::error::Fault;
use super::super::half::half;
use super::super::mends::{
    ACCESSOR_CUT, Mend, Mends, ODD_COMPONENTS, ODD_INDICES, SPARSE_LEFT, STRIDE_TOO_SMALL,
};
use super::super::text::shortened;
use super::buffers::Buffers;
use super::json::{Accessor, Document, Sparse};

/// An index that no mesh has, and one that stands for the end of a strip.
pub(super) const LOST: u32 = u32::MAX - 1;
pub(super) const BREAK: u32 = u32::MAX;

/// What accessors show, each bounds-checked before anything is allocated.
pub(super) struct Accessors<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: Buffers<'a>,
    /// What of them was mended.
    pub(super) notes: RefCell<Notes>,
}

/// What was mended, each accessor once.
#[derive(Default)]
pub(super) struct Notes {
    pub(super) mends: Mends,
    met: HashSet<(Mend, u32)>,
}

impl Notes {
    fn add(&mut self, mend: Mend, accessor: u32, what: &str) {
        if self.met.insert((mend, accessor)) {
            self.mends
                .add(mend, 1, || format!("is accessor {accessor}{what}"));
        }
    }
}

/// A kind of number, little end first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
    /// The last three belong to OpenGL, not to glTF.
    I32,
    F64,
    F16,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        let component = match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            5124 => Self::I32,
            5130 => Self::F64,
            5131 => Self::F16,
            _ => return None,
        };
        Some(component)
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::U32 | Self::F32 | Self::I32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_of_gltf(self) -> bool {
        !matches!(self, Self::I32 | Self::F64 | Self::F16)
    }

    /// The number at the start of `bytes`, which has enough of them.
    fn value(self, bytes: &[u8], normalised: bool) -> f64 {
        let word = || u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let (value, full) = match self {
            Self::I8 => (f64::from(bytes[0] as i8), f64::from(i8::MAX)),
            Self::U8 => (f64::from(bytes[0]), f64::from(u8::MAX)),
            Self::I16 => {
                let value = i16::from_le_bytes([bytes[0], bytes[1]]);
                (f64::from(value), f64::from(i16::MAX))
            }
            Self::U16 => {
                let value = u16::from_le_bytes([bytes[0], bytes[1]]);
                (f64::from(value), f64::from(u16::MAX))
            }
            Self::U32 => (f64::from(word()), f64::from(u32::MAX)),
            Self::F32 => (f64::from(f32::from_bits(word())), 1.0),
            Self::I32 => (f64::from(word() as i32), f64::from(i32::MAX)),
            Self::F64 => {
                let mut eight = [0; 8];
                eight.copy_from_slice(&bytes[..8]);
                (f64::from_le_bytes(eight), 1.0)
            }
            Self::F16 => (half(u16::from_le_bytes([bytes[0], bytes[1]])), 1.0),
        };
        if normalised {
            (value / full).max(-1.0)
        } else {
            value
        }
    }
}

/// Elements at equal distances in a view.
struct Rows<'a> {
    bytes: &'a [u8],
    stride: usize,
    /// Whether the view gives a stride that is too small for them.
    is_closer: bool,
    count: usize,
    component: Component,
    normalised: bool,
}

impl Rows<'_> {
    /// Numbers of an element; those that it does not have are 1.
    fn row<const N: usize>(&self, index: usize, width: usize) -> [f64; N] {
        let at = index * self.stride;
        let mut row = [1.0; N];
        for (number, value) in row.iter_mut().take(width).enumerate() {
            let bytes = &self.bytes[at + number * self.component.bytes()..];
            *value = self.component.value(bytes, self.normalised);
        }
        row
    }
}

/// An accessor whose bytes are there.
struct Opened<'a> {
    accessor: &'a Accessor,
    component: Component,
    width: usize,
    /// How many elements there are.
    count: u64,
    /// `None` where all elements are zero.
    rows: Option<Rows<'a>>,
}

fn width_of(shape: &str) -> Option<usize> {
    let width = match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        // Of others, columns may have gaps between them; none is asked for.
        "MAT4" => 16,
        _ => return None,
    };
    Some(width)
}

impl Accessors<'_> {
    /// The elements of an accessor, of one of these widths; numbers that an element does not have
    /// are 1.
    pub(super) fn rows<const N: usize>(
        &self,
        number: u32,
        widths: &[usize],
    ) -> Result<Vec<[f64; N]>, Fault> {
        let fault = |what: String| Fault::at(format!("accessor {number}"), what);
        let opened = self.open(number)?;
        let width = opened.width;
        if !widths.contains(&width) {
            let shape = &opened.accessor.shape;
            return Err(fault(format!(
                "its type is {shape}, which does not fit its use"
            )));
        }
        let mut rows = match &opened.rows {
            Some(rows) => (0..rows.count)
                .map(|index| rows.row(index, width))
                .collect(),
            None => {
                let mut zero = [1.0; N];
                zero[..width].fill(0.0);
                vec![zero; opened.count as usize]
            }
        };
        if let Some(sparse) = &opened.accessor.sparse {
            let lost = self.replace(&mut rows, sparse, &opened);
            if lost.map_err(|within| within.of(fault))? > 0 {
                self.notes.borrow_mut().add(SPARSE_LEFT, number, "");
            }
        }
        Ok(rows)
    }

    /// How many elements an accessor has: so many that there are bytes for them.
    pub(super) fn count(&self, number: u32) -> Result<u64, Fault> {
        self.open(number).map(|opened| opened.count)
    }

    /// Checks an accessor against the bytes that it names.
    fn open(&self, number: u32) -> Result<Opened<'_>, Fault> {
        let fault = |what: String| Fault::at(format!("accessor {number}"), what);
        let accessor = self.get(number)?;
        let component = component_of(accessor.component_type).map_err(fault)?;
        if !component.is_of_gltf() {
            self.notes.borrow_mut().add(ODD_COMPONENTS, number, "");
        }
        let width = width_of(&accessor.shape).ok_or_else(|| {
            let shape = shortened(&accessor.shape);
            fault(format!("its type is {shape:?}, which no mesh has"))
        })?;
        let rows = match accessor.buffer_view {
            Some(view) => {
                let rows = self.part(accessor, component, width, view);
                let rows = rows.map_err(|within| within.of(fault))?;
                if rows.is_closer {
                    self.notes.borrow_mut().add(STRIDE_TOO_SMALL, number, "");
                }
                let (said, found) = (accessor.count, rows.count as u64);
                if found < said {
                    let what = format!(", of {said} elements, of which {found} exist");
                    self.notes.borrow_mut().add(ACCESSOR_CUT, number, &what);
                }
                Some(rows)
            }
            None if accessor.count > self.buffers.total as u64 => {
                let what = "elements without bytes are more than all buffers have bytes";
                return Err(fault(format!("its {} {what}", accessor.count)));
            }
            None => None,
        };
        Ok(Opened {
            accessor,
            component,
            width,
            count: rows.as_ref().map_or(accessor.count, |it| it.count as u64),
            rows,
        })
    }

    /// The first of an accessor of 4 x 4 matrices.
    pub(super) fn first_matrix(&self, number: u32) -> Result<Option<[f64; 16]>, Fault> {
        let opened = self.open(number)?;
        if opened.width != 16 {
            let what = "its elements must be matrices";
            return Err(Fault::at(format!("accessor {number}"), what));
        }
        let rows = opened.rows.filter(|rows| rows.count > 0);
        Ok(rows.map(|rows| rows.row(0, 16)))
    }

    /// Which value stands for all light where an accessor shows colours: 1 of what is real or
    /// normalised, else the largest of its kind.
    pub(super) fn full_light(&self, number: u32) -> Result<f64, Fault> {
        let accessor = self.get(number)?;
        let full = match Component::of(accessor.component_type) {
            _ if accessor.normalized => 1.0,
            Some(Component::I8 | Component::U8) => f64::from(u8::MAX),
            Some(Component::I16 | Component::U16) => f64::from(u16::MAX),
            Some(Component::U32) => f64::from(u32::MAX),
            Some(Component::I32) => f64::from(i32::MAX),
            Some(Component::F32 | Component::F64 | Component::F16) | None => 1.0,
        };
        Ok(full)
    }

    /// The largest code of an accessor of normalised codes of sixteen bits; `None` for others.
    pub(super) fn full_code(&self, number: u32) -> Option<f64> {
        let accessor = self.get(number).ok()?;
        let is_code =
            accessor.normalized && Component::of(accessor.component_type) == Some(Component::U16);
        is_code.then_some(f64::from(u16::MAX))
    }

    /// The elements of an accessor of whole numbers; -1 is [`BREAK`], and anything else [`LOST`].
    pub(super) fn indices(&self, number: u32) -> Result<Vec<u32>, Fault> {
        let accessor = self.get(number)?;
        let whole = [
            Component::U8,
            Component::U16,
            Component::U32,
            Component::I32,
        ];
        let component = Component::of(accessor.component_type);
        if accessor.normalized {
            let what = "indices must be unsigned whole numbers";
            return Err(Fault::at(format!("accessor {number}"), what));
        }
        let rows = self.rows::<1>(number, &[1])?;
        if !component.is_some_and(|component| whole.contains(&component)) {
            self.notes.borrow_mut().add(ODD_INDICES, number, "");
        }
        let index = |[index]: [f64; 1]| match index {
            // It has the same bits as the largest.
            -1.0 => BREAK,
            index if index.fract() == 0.0 && index >= 0.0 => index as u32,
            _ => LOST,
        };
        Ok(rows.into_iter().map(index).collect())
    }

    /// The largest index of the kind of an accessor, by which graphics cards begin a strip again.
    pub(super) fn largest_index(&self, number: u32) -> Result<u32, Fault> {
        let kind = Component::of(self.get(number)?.component_type);
        Ok(match kind {
            Some(Component::U8 | Component::I8) => u32::from(u8::MAX),
            Some(Component::U16 | Component::I16) => u32::from(u16::MAX),
            _ => BREAK,
        })
    }

    /// What the document says of an accessor.
    pub(super) fn get(&self, number: u32) -> Result<&Accessor, Fault> {
        let accessors = &self.document.accessors;
        accessors.get(number as usize).ok_or_else(|| {
            let what = format!("there are only {} accessors", accessors.len());
            Fault::at(format!("accessor {number}"), what)
        })
    }

    /// As many elements of a view as are there, and at least one.
    fn part(
        &self,
        accessor: &Accessor,
        component: Component,
        width: usize,
        view: u32,
    ) -> Result<Rows<'_>, Within> {
        let bytes = self.buffers.view(self.document, view)?;
        let size = width * component.bytes();
        let said = self.document.buffer_views[view as usize].byte_stride;
        let stride = match said {
            // Some write 0 where elements follow each other without a gap.
            None | Some(0) => size,
            Some(stride) => usize::try_from(stride).unwrap_or(usize::MAX),
        };
        let is_closer = stride < size;
        let stride = stride.max(size);
        let fits = fitting(bytes.len() as u64, accessor.byte_offset, stride, size);
        if fits == 0 && accessor.count > 0 {
            let what = format!(
                "{} elements are said to be in buffer view {view}, but none fits into it",
                accessor.count
            );
            return Err(Within::Here(what));
        }
        let begin = (accessor.byte_offset as usize).min(bytes.len());
        Ok(Rows {
            bytes: &bytes[begin..],
            stride,
            is_closer,
            count: accessor.count.min(fits) as usize,
            component,
            normalised: accessor.normalized,
        })
    }

    /// Puts the elements of a sparse part in place of others; gives how many cannot be.
    fn replace<const N: usize>(
        &self,
        rows: &mut [[f64; N]],
        sparse: &Sparse,
        opened: &Opened<'_>,
    ) -> Result<usize, Within> {
        let Opened {
            accessor,
            component,
            width,
            ..
        } = *opened;
        let tight = |byte_offset, normalized| Accessor {
            count: sparse.count,
            byte_offset,
            normalized,
            ..Accessor::default()
        };
        let (at, values) = (&sparse.indices, &sparse.values);
        let kind = component_of(at.component_type)?;
        let at = self.part(&tight(at.byte_offset, false), kind, 1, at.buffer_view)?;
        let part = tight(values.byte_offset, accessor.normalized);
        let values = self.part(&part, component, width, values.buffer_view)?;
        let there = at.count.min(values.count);
        let mut lost = usize::try_from(sparse.count).unwrap_or(usize::MAX) - there;
        for index in 0..there {
            let [place] = at.row::<1>(index, 1);
            let row = (place >= 0.0)
                .then(|| rows.get_mut(place as usize))
                .flatten();
            match row {
                Some(row) => *row = values.row(index, width),
                None => lost += 1,
            }
        }
        Ok(lost)
    }
}

/// How many elements fit into a view.
fn fitting(bytes: u64, offset: u64, stride: usize, size: usize) -> u64 {
    match bytes
        .checked_sub(offset)
        .and_then(|left| left.checked_sub(size as u64))
    {
        Some(left) => left / stride as u64 + 1,
        None => 0,
    }
}

fn component_of(code: u32) -> Result<Component, String> {
    Component::of(code).ok_or_else(|| format!("its component type is {code}, which does not exist"))
}

/// What is wrong with an accessor itself, or with what it names.
enum Within {
    Here(String),
    There(Fault),
}

impl Within {
    fn of(self, fault: impl Fn(String) -> Fault) -> Fault {
        match self {
            Self::Here(what) => fault(what),
            Self::There(fault) => fault,
        }
    }
}

impl From<Fault> for Within {
    fn from(fault: Fault) -> Self {
        Self::There(fault)
    }
}

impl From<String> for Within {
    fn from(what: String) -> Self {
        Self::Here(what)
    }
}
