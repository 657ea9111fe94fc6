//! Many packets: what f64 leaves undecided waits until a packet of it is full.

use super::{Answers, Certified, Packet, Tier, WIDTH, Wish, Workspace};
use crate::math::packet::each;

/// Rays that wait, and where they come from.
#[derive(Default)]
struct Queue {
    packet: Packet,
    /// Packet and lane of each.
    from: Vec<(usize, usize)>,
}

impl Queue {
    fn push(&mut self, packets: &[Packet], index: usize, lane: usize) {
        let (source, to) = (&packets[index], self.from.len());
        let ray = source.ray(lane);
        let limits = [source.t_min[lane], source.t_max[lane]];
        self.packet.set(to, ray.origin, ray.direction, limits);
        self.packet.leaving |= (source.leaving >> lane & 1) << to;
        // The coarser of two roundings holds for both.
        self.packet.roundoff = self.packet.roundoff.max(source.roundoff);
        self.from.push((index, lane));
    }
}

impl Certified {
    /// The first hits of many packets, with the answers that [`Certified::first_hits`] has for each.
    pub fn first_hits_of_all(
        &self,
        packets: &[Packet],
        wish: Wish,
        workspace: &mut Workspace,
    ) -> Vec<Answers> {
        let mut answers = Vec::with_capacity(packets.len());
        let mut queue = Queue::default();
        for (index, packet) in packets.iter().enumerate() {
            let first = self.in_lanes(packet, packet.active, false, workspace);
            let again = first.unfinished(packet, wish);
            answers.push(first);
            for lane in each(again) {
                queue.push(packets, index, lane);
                if queue.from.len() == WIDTH {
                    self.empty(&mut queue, packets, &mut answers, wish, workspace);
                }
            }
        }
        self.empty(&mut queue, packets, &mut answers, wish, workspace);
        answers
    }

    fn empty(
        &self,
        queue: &mut Queue,
        packets: &[Packet],
        answers: &mut [Answers],
        wish: Wish,
        workspace: &mut Workspace,
    ) {
        let Queue { packet, from } = std::mem::take(queue);
        if from.is_empty() {
            return;
        }
        let sharper = self.in_lanes(&packet, packet.active, true, workspace);
        let decided = sharper.found | sharper.absent;
        for (at, (index, lane)) in from.into_iter().enumerate() {
            let to = &mut answers[index];
            let was_open = (to.found | to.absent) >> lane & 1 == 0;
            let is_decided = decided >> at & 1 == 1;
            if is_decided || was_open {
                to.tiers[lane] = Tier::DoubleDouble;
                to.take_from(&sharper, at, lane);
            }
            if was_open && !is_decided && wish.exact {
                to.tiers[lane] = Tier::Exact;
                self.settle(&packets[index], lane, to, workspace);
            }
        }
    }
}
