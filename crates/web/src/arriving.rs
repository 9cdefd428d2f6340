//! What does it mean that a stretch of the file came?

use crate::page_player::PagePlayer;
use crate::stretches::{Arrival, Need, Part};
use foveal_core::content::demand::Content;
use foveal_core::content::opened::Opened;
use foveal_core::pack::PackError;
use foveal_core::session::actions::SessionEvent;

impl PagePlayer {
    /// Takes what [`Self::needs`] asked for; what it did not ask for is passed over. Says what is
    /// wrong with it once: where it is damaged although it was fetched again. It then counts as
    /// damaged for good.
    pub fn arrived(&mut self, offset: u64, bytes: &[u8]) -> Result<Arrival, String> {
        let length = bytes.len() as u64;
        let is_it = |need: &&Need| (need.offset, need.bytes) == (offset, length);
        let found = self.fetching.needs.iter().filter(is_it);
        let found: Vec<Need> = found.cloned().collect();
        let Some(first) = found.first() else {
            return Ok(Arrival::Taken);
        };
        let error = match self.take_stretch(first, bytes) {
            Ok(arrival) => return Ok(arrival),
            Err(error) => error,
        };
        let times = self.fetching.damaged.entry(offset).or_default();
        *times += 1;
        let times = *times;
        if times > 1 {
            found.iter().for_each(|need| self.lose(need));
        }
        match times {
            1 => Ok(Arrival::Again),
            2 => Err(error.to_string()),
            _ => Ok(Arrival::Taken),
        }
    }

    fn take_stretch(&mut self, need: &Need, bytes: &[u8]) -> Result<Arrival, PackError> {
        match (&need.part, &self.pack.content) {
            (Part::Page(page), Opened::Video(video)) => {
                video.pack().index().add_page(*page, bytes)?;
                return Ok(Arrival::More);
            }
            (Part::Table(name), Opened::Video(video)) => {
                video.add_table(name, bytes.to_vec())?;
                self.play.session_mut().take(SessionEvent::TableLoaded);
            }
            (Part::Unit(unit), Opened::Video(video)) => {
                let mut edges = vec![bytes.len() as u32];
                for unit in video.access_units(*unit, bytes)?.iter().rev() {
                    edges.insert(0, edges[0] - unit.len() as u32);
                }
                return Ok(Arrival::Decode(edges));
            }
            (Part::Unit(unit), Opened::Scene(scene)) => {
                let what = format!("chunk of unit {}", unit.0);
                scene.place(*unit).known(&what)?.check(&what, bytes)?;
                let payload = scene.pack().payload(*unit, bytes)?;
                self.deliver(unit.0, 0, 1, Some(payload));
            }
            _ => {}
        }
        Ok(Arrival::Taken)
    }

    /// What is damaged cannot be had.
    fn lose(&mut self, need: &Need) {
        match (&need.part, &self.pack.content) {
            (Part::Page(page), Opened::Video(video)) => video.fail_page(*page),
            (Part::Table(name), Opened::Video(video)) => video.fail_table(name),
            (Part::Unit(unit), _) => {
                let frame = need.picture.map_or(0, |picture| picture.frame);
                self.deliver(unit.0, frame, 0, None);
            }
            _ => {}
        }
    }
}
