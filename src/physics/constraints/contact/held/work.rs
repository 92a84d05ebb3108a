//! What friction takes from particles that stay in contact, and what moving obstacles do by it.

use super::Held;
use crate::physics::State;
use crate::space::{dot, minus, norm, three};
use std::borrow::Cow;

impl Held<'_> {
    /// Where the friction of sliding particles is not among the forces: its flow over `h`, s, at a state in the axes of
    /// space, which takes µ N h / m off the speed and leaves its direction. Books what it takes.
    pub fn slow_down(&self, h: f64, state: &mut State) {
        if self.friction {
            return;
        }
        let begins = state.t == self.since;
        let a = if begins {
            Cow::Borrowed(&self.begins)
        } else {
            Cow::Owned(self.free(state))
        };
        for member in self.members.iter().filter(|member| member.slides) {
            let now = if begins {
                Cow::Borrowed(&member.contacts)
            } else {
                member.contacts.now(self.obstacles, state)
            };
            let pressed = now.pressed(self.obstacles, state.t, three(&a, member.particle));
            let along = now.outer_sliding(self.obstacles, state);
            let fast = norm(along);
            let lost = (h * now.resistance(&pressed, 0)).min(fast);
            if fast > 0.0 {
                let mass = 1.0 / self.system.inverse_mass()[3 * member.particle];
                for axis in 0..3 {
                    state.v[3 * member.particle + axis] -= lost / fast * along[axis];
                }
                state.work.friction += mass * lost * (fast - 0.5 * lost);
            }
        }
    }

    /// Whether there is work to [`book`](Self::book).
    pub fn books(&self) -> bool {
        let slides = self.friction && self.members.iter().any(|member| member.slides);
        self.obstacles.any_moves() || slides || !self.groups.is_empty()
    }

    /// Adds the work of friction among the forces, and of moving obstacles, over `h` seconds from a state to another, at
    /// which the acceleration without contact is `a`: by Simpson's rule, with the middle of the cubic through both.
    pub fn book(&self, h: f64, start: &State, end: &mut State, a: &[f64]) {
        if !self.books() {
            return;
        }
        let middle = start.middle(end, h);
        let parts = [
            self.powers(start, &self.begins),
            self.powers(&middle, &self.free(&middle)),
            self.powers(end, a),
        ];
        for ([lost, given], weight) in parts.into_iter().zip([1.0, 4.0, 1.0]) {
            end.work.friction += weight * h / 6.0 * lost;
            end.work.injected += weight * h / 6.0 * given;
        }
    }

    /// The power lost to friction among the forces, and that of the obstacles' motions, W, at a state in the axes of space
    /// with the acceleration `a` without contact.
    fn powers(&self, state: &State, a: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for member in &self.members {
            let now = member.contacts.now(self.obstacles, state);
            let mass = 1.0 / self.system.inverse_mass()[3 * member.particle];
            let free = three(a, member.particle);
            let pressed = now.pressed(self.obstacles, state.t, free);
            let [_, along, pushed] = self.obstacles.moved(now[0].beside.against, state.t);
            let mut force = [0.0; 3];
            for (n, contact) in pressed.iter().zip(now.iter()) {
                for axis in 0..3 {
                    force[axis] += n * contact.beside.normal[axis];
                }
            }
            if member.slides {
                let sliding = now.outer_sliding(self.obstacles, state);
                let direction = member.rubbed(sliding);
                let lost = now.resistance(&pressed, 0);
                if self.friction {
                    sums[0] += mass * lost * dot(direction, sliding);
                }
                for axis in 0..3 {
                    force[axis] -= lost * direction[axis];
                }
            } else if member.sticks() {
                force = minus(pushed, free);
            }
            sums[1] += mass * dot(force, along);
        }
        for group in &self.groups {
            let own = group.powers(self.obstacles, self.system.rods(), state, a);
            sums = [sums[0] + own[0], sums[1] + own[1]];
        }
        sums
    }
}
