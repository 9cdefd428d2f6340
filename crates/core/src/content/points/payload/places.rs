//! How are the places of points written?
//!
//! Points are sorted along a curve through their cube (Morton 1966), or along one through a plane
//! of two axes, with the third coordinate apart: whichever takes fewer bits.
//!
//! 1. Through space: the high bits of each coordinate, from the cube's corner, at most 21, make a
//!    number: bit `n` of x, y and z is its bit `3 n`, `3 n + 1` and `3 n + 2`. A list of what is
//!    added to the number before, from 0. Then, where any are left, a block of bits: of each point
//!    those of x, y and z, as they are.
//! 2. Along a plane: the same of all bits of the plane's two axes, in the order x, y, z. Then
//!    a list of what is added to the third coordinate of the point before, from 0.

use crate::content::bits::{BitReader, BitWriter};
use crate::content::points::cloud_point::{CloudPoint, wrong};
use crate::content::points::curve::{
    BITS_OF_THREE, number_of_three, number_of_two, three_of_number, two_of_number,
};
use crate::content::points::lengths::{
    NumberList, bits_of_numbers, signed_from_unsigned, take_block, unsigned_from_signed,
    write_block, write_list,
};
use crate::pack::PackError;

/// Most bits of a place along an axis.
pub(super) const MOST_BITS: u8 = 32;

/// A cube: its corner, and the bits of a place in it.
pub(super) type Cube = ([u32; 3], u8);

/// The order of points in a unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Along a curve through space.
    #[default]
    Space = 0,
    /// Along a curve through the plane of y and z.
    BesideX = 1,
    /// Along a curve through the plane of x and z.
    BesideY = 2,
    /// Along a curve through the plane of x and y.
    BesideZ = 3,
}

impl Order {
    const ALL: [Self; 4] = [Self::Space, Self::BesideX, Self::BesideY, Self::BesideZ];

    /// The order of this number.
    #[must_use]
    pub fn of(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|it| *it as u8 == number)
    }

    /// The axes that a curve goes by, and the remaining one.
    fn axes(self) -> ([usize; 2], usize) {
        match self {
            Self::Space | Self::BesideZ => ([0, 1], 2),
            Self::BesideX => ([1, 2], 0),
            Self::BesideY => ([0, 2], 1),
        }
    }
}

/// How places of a cube become numbers.
#[derive(Clone, Copy)]
struct Curve {
    order: Order,
    corner: [u32; 3],
    /// Bits of each coordinate that make the number.
    high: u32,
    /// Bits of each coordinate that are left.
    low: u32,
}

impl Curve {
    fn new((corner, bits): Cube, order: Order) -> Self {
        let bits = u32::from(bits);
        let high = match order {
            Order::Space => bits.min(BITS_OF_THREE),
            _ => bits,
        };
        Self {
            order,
            corner,
            high,
            low: bits - high,
        }
    }

    /// A place from the corner on.
    fn inner(&self, point: &CloudPoint) -> [u32; 3] {
        [0, 1, 2].map(|axis| point.place[axis].wrapping_sub(self.corner[axis]))
    }

    fn number(&self, point: &CloudPoint) -> u64 {
        let place = self.inner(point);
        let high = place.map(|it| it >> self.low);
        let ([u, v], _) = self.order.axes();
        match self.order {
            Order::Space => number_of_three(high),
            _ => number_of_two([high[u], high[v]]),
        }
    }

    /// The bits that are left of a coordinate.
    fn rest(&self, point: &CloudPoint, axis: usize) -> u32 {
        self.inner(point)[axis] & ((1 << self.low) - 1)
    }

    /// What is added to the number of the point before.
    fn gaps(&self, points: &[CloudPoint]) -> Vec<u64> {
        let mut before = 0;
        let gap = |point| {
            let number = self.number(point);
            number - core::mem::replace(&mut before, number)
        };
        points.iter().map(gap).collect()
    }

    /// What is added to the third coordinate of the point before.
    fn steps(&self, points: &[CloudPoint]) -> Vec<u64> {
        let (_, beside) = self.order.axes();
        let mut before = 0;
        let step = |point| {
            let along = i64::from(self.inner(point)[beside]);
            unsigned_from_signed(along - core::mem::replace(&mut before, along))
        };
        points.iter().map(step).collect()
    }
}

/// Puts points in the order in which they are written in the fewest bits, and returns that.
pub(super) fn ordered(points: &mut [CloudPoint], cube: Cube) -> Order {
    let mut best = (u64::MAX, Order::Space);
    for order in Order::ALL {
        let curve = sorted(points, cube, order);
        let mut cost = u64::from(3 * curve.low) * points.len() as u64;
        cost += bits_of_numbers(&curve.gaps(points));
        if order != Order::Space {
            cost += bits_of_numbers(&curve.steps(points));
        }
        best = if cost < best.0 { (cost, order) } else { best };
    }
    sorted(points, cube, best.1);
    best.1
}

fn sorted(points: &mut [CloudPoint], cube: Cube, order: Order) -> Curve {
    let curve = Curve::new(cube, order);
    // All of a point counts, so that no order before it does.
    points.sort_by_cached_key(|point| (curve.number(point), *point));
    curve
}

/// Writes the places of points that are in this order.
pub(super) fn write_places(points: &[CloudPoint], cube: Cube, order: Order, bytes: &mut Vec<u8>) {
    let curve = Curve::new(cube, order);
    write_list(&curve.gaps(points), bytes);
    if curve.low > 0 {
        let mut bits = BitWriter::default();
        for point in points {
            for axis in 0..3 {
                bits.plain(curve.rest(point, axis), curve.low);
            }
        }
        write_block(&bits.finish(), bytes);
    }
    if order != Order::Space {
        write_list(&curve.steps(points), bytes);
    }
}

/// Reads the places of points.
pub(super) fn read_places(
    points: &mut [CloudPoint],
    cube: Cube,
    order: Order,
    bytes: &mut &[u8],
) -> Result<(), PackError> {
    let curve = Curve::new(cube, order);
    let are_inside = match order {
        Order::Space => read_along_space(points, &curve, bytes)?,
        _ => read_along_plane(points, &curve, bytes)?,
    };
    if !are_inside {
        return Err(wrong("place", "beyond its cube", "in its cube"));
    }
    for point in points {
        for (along, corner) in point.place.iter_mut().zip(curve.corner) {
            *along = along.wrapping_add(corner);
        }
    }
    Ok(())
}

/// Numbers that only grow, which begin from 0.
#[derive(Default)]
struct Growing {
    number: u64,
    /// All bits that any of them has; the highest where one ran over. Which also shows where the
    /// highest bit of a number is set that has no such bit.
    all: u64,
}

impl Growing {
    #[inline]
    fn next(&mut self, gap: u64) -> u64 {
        let (sum, overflows) = self.number.overflowing_add(gap);
        self.number = sum;
        self.all |= sum | u64::from(overflows) << 63;
        sum
    }

    /// Whether all of them have at most so many bits.
    fn are_below(&self, bits: u32) -> bool {
        self.all.unbounded_shr(bits) == 0
    }
}

/// Reads places from the corner on; whether they lie in the cube.
fn read_along_space(
    points: &mut [CloudPoint],
    curve: &Curve,
    bytes: &mut &[u8],
) -> Result<bool, PackError> {
    let mut gaps = NumberList::take(bytes)?;
    let mut numbers = Growing::default();
    for point in points.iter_mut() {
        point.place = three_of_number(numbers.next(gaps.next()));
    }
    gaps.end()?;
    if curve.low > 0 {
        let mut bits = BitReader::new(take_block(bytes)?);
        for point in points.iter_mut() {
            for along in &mut point.place {
                *along = *along << curve.low | bits.plain(curve.low);
            }
        }
        if !matches!(bits.left(), Some(0..8)) {
            let left = format!("{:?} bits left", bits.left());
            return Err(wrong("places", left, "none but to the byte"));
        }
    }
    Ok(numbers.are_below(3 * curve.high))
}

/// The same along a plane, and along the third axis.
fn read_along_plane(
    points: &mut [CloudPoint],
    curve: &Curve,
    bytes: &mut &[u8],
) -> Result<bool, PackError> {
    let mut gaps = NumberList::take(bytes)?;
    let mut steps = NumberList::take(bytes)?;
    let ([u, v], beside) = curve.order.axes();
    let mut numbers = Growing::default();
    let (mut along, mut all) = (0_i64, 0);
    for point in points.iter_mut() {
        let number = numbers.next(gaps.next());
        along = along.wrapping_add(signed_from_unsigned(steps.next()));
        all |= along;
        [point.place[u], point.place[v]] = two_of_number(number);
        point.place[beside] = along as u32;
    }
    gaps.end()?;
    steps.end()?;
    Ok(numbers.are_below(2 * curve.high) && (all as u64).unbounded_shr(curve.high) == 0)
}
