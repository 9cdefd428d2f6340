//! Which connections are open, and which ends when there are too many?

use std::collections::BTreeMap;
use std::net::IpAddr;
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
    /// Told when the connection must end.
    pub(super) ends: Arc<Notify>,
}

/// An answer under way: while it lasts its connection is not idle.
pub(super) struct Answering {
    among: Arc<Connections>,
    number: u64,
}

impl Connections {
    /// Takes a connection in. Where there are too many, of its address or of all, the one that has
    /// been idle longest ends; `None` where none of them is idle.
    pub(super) fn admit(self: &Arc<Self>, address: IpAddr) -> Option<Admitted> {
        let mut open = self.open();
        let of_address = open.values().filter(|it| it.address == address).count();
        if !address.is_loopback() && of_address >= MOST_OF_ADDRESS {
            end_idlest(&mut open, |it| it.address == address)?;
        }
        if open.len() >= MOST {
            end_idlest(&mut open, |_| true)?;
        }
        let number = open.last_key_value().map_or(0, |(last, _)| last + 1);
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
        Some(Admitted {
            among: Arc::clone(self),
            number,
            ends,
        })
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

/// Ends the connection that has been idle longest.
fn end_idlest(
    open: &mut BTreeMap<u64, OpenConnection>,
    among: impl Fn(&OpenConnection) -> bool,
) -> Option<()> {
    let idle = open.iter().filter(|(_, it)| it.busy == 0 && among(it));
    let (number, _) = idle.min_by_key(|(_, it)| it.since)?;
    let number = *number;
    let gone = open.remove(&number)?;
    gone.ends.notify_one();
    Some(())
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
        let mut kept: Vec<Admitted> = (0..MOST).map(|_| all.admit(HERE).unwrap()).collect();
        let busy = kept[0].answering();
        let newest = all.admit(HERE).unwrap();
        assert_eq!(all.open().len(), MOST);
        assert!(all.open().contains_key(&0) && !all.open().contains_key(&1));
        drop(busy);
        kept.clear();
        drop(newest);
        assert!(all.open().is_empty());
    }

    #[test]
    fn none_comes_in_while_all_are_busy() {
        let all = Arc::new(Connections::default());
        let kept: Vec<Admitted> = (0..MOST).map(|_| all.admit(HERE).unwrap()).collect();
        let busy: Vec<Answering> = kept.iter().map(Admitted::answering).collect();
        assert!(all.admit(HERE).is_none());
        drop(busy);
        assert!(all.admit(HERE).is_some());
    }

    #[test]
    fn one_address_of_another_machine_has_a_few() {
        let all = Arc::new(Connections::default());
        let here: Vec<Admitted> = (0..MOST_OF_ADDRESS + 9)
            .map(|_| all.admit(HERE).unwrap())
            .collect();
        let there: Vec<Admitted> = (0..MOST_OF_ADDRESS + 9)
            .map(|_| all.admit(ELSEWHERE).unwrap())
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
