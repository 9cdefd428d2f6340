//! Which connections are open, and which ends when there are too many?

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;
use tokio::sync::Notify;

/// Connections at a time; a browser opens six.
const MOST: usize = 256;
/// Connections of one address of another machine.
const MOST_OF_ADDRESS: usize = 32;

/// The connections that are open.
#[derive(Debug, Default)]
pub(super) struct Connections {
    /// Number of the next one: none has one twice.
    next: AtomicU64,
    open: Mutex<BTreeMap<u64, OpenConnection>>,
}

#[derive(Debug)]
struct OpenConnection {
    address: IpAddr,
    /// When it last asked or was answered.
    since: Instant,
    /// Requests that are being answered.
    busy: u32,
    ends: Arc<Notify>,
}

/// A place among the connections, given back with the value.
pub(super) struct Admitted {
    among: Arc<Connections>,
    number: u64,
    /// Signalled when the connection must end.
    pub(super) ends: Arc<Notify>,
}

/// An answer under way: while it lasts its connection is not idle.
pub(super) struct Answering {
    among: Arc<Connections>,
    number: u64,
}

impl Connections {
    /// Takes a connection in. Where there are too many, of its address or of all, the one that has
    /// been idle longest ends; where none is idle, the one that has been answered longest: who
    /// reads slowly can ask for the rest, and must not keep others out.
    pub(super) fn admit(self: &Arc<Self>, address: IpAddr) -> Admitted {
        let mut open = self.open();
        let of_address = open.values().filter(|it| it.address == address).count();
        if !address.is_loopback() && of_address >= MOST_OF_ADDRESS {
            end_one(&mut open, |it| it.address == address);
        }
        if open.len() >= MOST {
            end_one(&mut open, |_| true);
        }
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let ends = Arc::new(Notify::new());
        open.insert(
            number,
            OpenConnection {
                address,
                since: Instant::now(),
                busy: 0,
                ends: Arc::clone(&ends),
            },
        );
        Admitted {
            among: Arc::clone(self),
            number,
            ends,
        }
    }

    fn open(&self) -> MutexGuard<'_, BTreeMap<u64, OpenConnection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, number: u64, more: i32) {
        if let Some(it) = self.open().get_mut(&number) {
            it.since = Instant::now();
            it.busy = it.busy.saturating_add_signed(more);
        }
    }
}

/// Ends the connection that has been idle longest, or else answered longest.
fn end_one(open: &mut BTreeMap<u64, OpenConnection>, among: impl Fn(&OpenConnection) -> bool) {
    let all = open.iter().filter(|(_, it)| among(it));
    let first = all.min_by_key(|(_, it)| (it.busy > 0, it.since));
    let number = first.map(|(number, _)| *number);
    if let Some(gone) = number.and_then(|number| open.remove(&number)) {
        gone.ends.notify_one();
    }
}

impl Admitted {
    /// Notes that a request is being answered.
    pub(super) fn answering(&self) -> Answering {
        self.among.note(self.number, 1);
        Answering {
            among: Arc::clone(&self.among),
            number: self.number,
        }
    }
}

impl Drop for Admitted {
    fn drop(&mut self) {
        self.among.open().remove(&self.number);
    }
}

impl Drop for Answering {
    fn drop(&mut self) {
        self.among.note(self.number, -1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
    const ELSEWHERE: IpAddr = IpAddr::V4(Ipv4Addr::new(192, 0, 2, 1));

    #[test]
    fn the_connection_that_has_been_idle_longest_ends_for_one_that_comes() {
        let all = Arc::new(Connections::default());
        let mut kept: Vec<Admitted> = (0..MOST).map(|_| all.admit(HERE)).collect();
        let busy = kept[0].answering();
        let newest = all.admit(HERE);
        assert_eq!(all.open().len(), MOST);
        assert!(all.open().contains_key(&0) && !all.open().contains_key(&1));
        drop(busy);
        kept.clear();
        drop(newest);
        assert!(all.open().is_empty());
    }

    #[test]
    fn where_none_is_idle_the_one_that_has_been_answered_longest_ends() {
        let all = Arc::new(Connections::default());
        let kept: Vec<Admitted> = (0..MOST).map(|_| all.admit(HERE)).collect();
        let busy: Vec<Answering> = kept.iter().rev().map(Admitted::answering).collect();
        let newest = all.admit(HERE);
        let last = MOST as u64 - 1;
        assert!(all.open().contains_key(&0) && !all.open().contains_key(&last));
        drop((busy, newest));
    }

    #[test]
    fn one_address_of_another_machine_has_a_few() {
        let all = Arc::new(Connections::default());
        let here: Vec<Admitted> = (0..MOST_OF_ADDRESS + 9).map(|_| all.admit(HERE)).collect();
        let there: Vec<Admitted> = (0..MOST_OF_ADDRESS + 9)
            .map(|_| all.admit(ELSEWHERE))
            .collect();
        let of_there = all
            .open()
            .values()
            .filter(|it| it.address == ELSEWHERE)
            .count();
        assert_eq!(of_there, MOST_OF_ADDRESS);
        assert_eq!(here.len(), there.len());
    }
}
