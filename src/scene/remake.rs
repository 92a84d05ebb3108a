//! A scene once more, from other objects.

use super::complete::expanded;
use super::error::Refusal;
use super::model::{Scene, Written};
use super::object::{Body, Object, Scaling};
use super::place::Problem;
use std::sync::Arc;

impl Scene {
    /// The scene with other objects; solver and duration stay. What has no objects stays as it is.
    ///
    /// # Errors
    /// [`Refusal`] with the key of what cannot be made.
    pub fn remade(&self, change: impl FnOnce(&mut Vec<Object>)) -> Result<Self, Refusal> {
        self.renamed(change, &|name| name.to_owned())
    }

    /// The scene with every link of its objects cut into so many. Particles that are named stay at their places.
    ///
    /// # Errors
    /// As [`remade`](Self::remade).
    pub fn refined(&self, links: u64, scaling: Scaling) -> Result<Self, Refusal> {
        let finer = |name: &str| {
            let id = self.particle_named(name).ok();
            let found = id.and_then(|id| self.body_of(id));
            found.map_or_else(
                || name.to_owned(),
                |(body, place)| body.called(&finer(&place, links)),
            )
        };
        let change = |objects: &mut Vec<Object>| {
            objects.iter_mut().for_each(|o| o.refine(links, scaling));
        };
        self.renamed(change, &finer)
    }

    /// The scene without its strain limit, and so are those that are made of it.
    pub fn without_strain_limit(&self) -> Self {
        let written = self.written.as_ref().map(|written| {
            Arc::new(Written {
                scene: written.scene.without_strain_limit(),
                named: written.named.clone(),
            })
        });
        Self {
            strain_limit: None,
            written,
            ..self.clone()
        }
    }

    /// The id of the same particle in this scene [refined](Self::refined).
    pub fn refined_id(&self, refined: &Self, id: usize, links: u64) -> Option<usize> {
        let Some((body, place)) = self.body_of(id) else {
            return (id < refined.particles.len()).then_some(id);
        };
        let mut bodies = refined.bodies.iter();
        let body = bodies.find(|other| other.name == body.name)?;
        body.id(&finer(&place, links))
    }

    /// The object that a particle belongs to, and its place there.
    fn body_of(&self, id: usize) -> Option<(&Body, Vec<usize>)> {
        let mut bodies = self.bodies.iter();
        bodies.find_map(|body| Some((body, body.place(id)?)))
    }

    fn renamed(
        &self,
        change: impl FnOnce(&mut Vec<Object>),
        name: &dyn Fn(&str) -> String,
    ) -> Result<Self, Refusal> {
        let Some(written) = &self.written else {
            return Ok(self.clone());
        };
        let mut scene = Self {
            solver: self.solver.clone(),
            duration: self.duration,
            ..written.scene.clone()
        };
        change(&mut scene.objects);
        let mut named = written.named.clone();
        named
            .iter_mut()
            .for_each(|named| named.name = name(&named.name));
        let scene = expanded(scene, &named, None).map_err(Problem::refusal)?;
        Ok(Self {
            written: self.written.clone(),
            ..scene
        })
    }
}

/// The place of the same particle once every link is cut into so many.
fn finer(place: &[usize], links: u64) -> Vec<usize> {
    place.iter().map(|at| at * links as usize).collect()
}
