//! `--board sim:`: the link to a simulated board as a port, in simulated time.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use arcfeed_hil_sim::override_source::OverrideSource;
use arcfeed_hil_sim::override_source::board::{AttachedDevices, Traffic, Wire};
use arcfeed_units::Micros;

use super::sim_port::SimPort;
use crate::port::{Port, PortError};

/// Bytes under way between host and simulated board, in both directions.
#[derive(Debug, Default)]
pub struct Pipe {
    to_board: Vec<u8>,
    to_host: VecDeque<u8>,
}

/// Board's end of the pipe.
#[derive(Debug)]
pub struct BoardEnd(pub Rc<RefCell<Pipe>>);

impl AttachedDevices for BoardEnd {
    fn send(&mut self, _at: Micros, traffic: &mut Traffic) {
        traffic.link.append(&mut self.0.borrow_mut().to_board);
    }

    fn receive(&mut self, _at: Micros, wire: Wire, bytes: &[u8]) {
        // Nothing is on the tapped lines.
        if wire == Wire::Link {
            self.0.borrow_mut().to_host.extend(bytes);
        }
    }
}

/// Host's end of the pipe.
pub struct SimLink<D> {
    sim: Rc<RefCell<SimPort<D>>>,
    pipe: Rc<RefCell<Pipe>>,
}

impl<D> SimLink<D> {
    /// Host's end of a pipe to the board of a machine.
    pub fn new(sim: Rc<RefCell<SimPort<D>>>, pipe: Rc<RefCell<Pipe>>) -> Self {
        SimLink { sim, pipe }
    }
}

impl<D: OverrideSource> Port for SimLink<D> {
    fn now(&self) -> Micros {
        self.sim.borrow().now()
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let mut pipe = self.pipe.borrow_mut();
        let len = pipe.to_host.len().min(buffer.len());
        buffer.iter_mut().zip(pipe.to_host.drain(..len)).for_each(|(slot, byte)| *slot = byte);
        Ok(len)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.pipe.borrow_mut().to_board.extend(bytes);
        Ok(bytes.len())
    }

    fn wait(&mut self, deadline: Micros) {
        self.sim.borrow_mut().wait(deadline);
    }
}
