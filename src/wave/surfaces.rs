//! Surfaces that are more than plain diffuse ones: interact, texture, light, respond.
//!
//! In: an index list of one shader. Out: scattered paths and occlusion rays, behind those of the
//! lists before. The queues between the passes are used by one list after the other, so that
//! what a pass writes is still in the cache when the next one reads it; a render without such surfaces
//! has none of them.

use super::plan::QueuePlan;
use super::queue::Queue;
use super::sampling::{AnySampler, with_sampler};
use super::shade::Program;
use crate::effects::Shader;
use huygens_kernels::queues::{
    self, AlignedMut, DrawnMut, Listed, LitMut, SmoothMut, SurfacesMut, TexturedMut,
};
use huygens_kernels::scatter::align::align;
use huygens_kernels::scatter::interact::interact;
use huygens_kernels::scatter::kinds;
use huygens_kernels::scatter::light_up::light_up;
use huygens_kernels::scatter::respond::{Kind, Rows, respond};
use huygens_kernels::scatter::texture::{Layout, texture};
use huygens_kernels::scatter::{LightsAlone, LightsWeighted, NoLights, Out};
use huygens_kernels::tables::{Materials, Tables};

/// Which queues there are beside those of all surfaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// For samples of lights.
    pub(crate) lights: bool,
    /// For normals that are interpolated or bent.
    pub(crate) smooth: bool,
    /// For images.
    pub(crate) textured: bool,
    /// For brushed surfaces.
    pub(crate) aligned: bool,
}

/// The queues between the passes.
pub(crate) struct Surfaces {
    surfaces: Queue<SurfacesMut<'static>>,
    drawn: Queue<DrawnMut<'static>>,
    /// Of no capacity where lights are not sampled.
    lit: Queue<LitMut<'static>>,
    /// Where normals are interpolated or bent.
    smooth: Option<Queue<SmoothMut<'static>>>,
    /// Where some are brushed along texture coordinates.
    aligned: Option<Queue<AlignedMut<'static>>>,
    /// Where materials read images.
    textured: Option<Queue<TexturedMut<'static>>>,
}

impl Surfaces {
    pub(crate) fn new(capacity: usize, wanted: Wanted) -> Self {
        let Wanted {
            lights,
            smooth,
            textured,
            aligned,
        } = wanted;
        Self {
            surfaces: Queue::new(capacity),
            drawn: Queue::new(capacity),
            lit: Queue::new(if lights { capacity } else { 0 }),
            smooth: smooth.then(|| Queue::new(capacity)),
            aligned: aligned.then(|| Queue::new(capacity)),
            textured: textured.then(|| Queue::new(capacity)),
        }
    }

    /// Its queues, as they are.
    pub(crate) fn queues(&self) -> impl Iterator<Item = QueuePlan> {
        let surfaces = QueuePlan::of("surfaces", &self.surfaces);
        let drawn = QueuePlan::of("drawn numbers", &self.drawn);
        let lit = QueuePlan::of("light samples", &self.lit);
        let smooth = self.smooth.as_ref();
        let smooth = smooth.and_then(|queue| QueuePlan::of("interpolated surfaces", queue));
        let textured = self.textured.as_ref();
        let textured = textured.and_then(|queue| QueuePlan::of("textured surfaces", queue));
        let aligned = self.aligned.as_ref();
        let aligned = aligned.and_then(|queue| QueuePlan::of("aligned surfaces", queue));
        [surfaces, smooth, textured, aligned, drawn, lit]
            .into_iter()
            .flatten()
    }

    /// What the listed paths met.
    pub(crate) fn interact(&mut self, listed: Listed, tables: &Tables, sampler: AnySampler) {
        let (surfaces, drawn) = (self.surfaces.view_mut(), self.drawn.view_mut());
        let smooth = self.smooth.as_mut().map(Queue::view_mut);
        with_sampler!(sampler, s => interact(listed, tables, s, surfaces, drawn, smooth));
        self.surfaces.set_len(listed.len);
        self.drawn.set_len(listed.len);
    }

    /// What images say of them.
    pub(crate) fn texture(&mut self, listed: Listed, tables: &Tables, layout: &Layout) {
        if let Some(textured) = &mut self.textured {
            let surfaces = self.surfaces.view_mut();
            texture(listed, tables, layout, surfaces, textured.view_mut());
            textured.set_len(listed.len);
        }
    }

    /// Which way they lie.
    pub(crate) fn align(&mut self, listed: Listed, tables: &Tables) {
        if let Some(aligned) = &mut self.aligned {
            align(
                listed,
                tables,
                self.surfaces.view(),
                &mut aligned.view_mut(),
            );
            aligned.set_len(listed.len);
        }
    }

    /// What was met last, row by row of its list.
    pub(crate) fn rows(&self) -> queues::Surfaces<'_> {
        self.surfaces.view()
    }

    /// One sample of the light around each.
    pub(crate) fn light_up(&mut self, shader: Shader, tables: &Tables) {
        let n = self.surfaces.len();
        let (surfaces, drawn) = (self.surfaces.view(), self.drawn.view());
        let passes = shader.passes();
        light_up(n, surfaces, drawn, tables, passes, self.lit.view_mut());
        self.lit.set_len(n);
    }

    /// What the BSDF makes of both, with the parameters of `textured` surfaces as images left them.
    #[expect(clippy::too_many_arguments, reason = "each a thing of its own")]
    pub(crate) fn respond<'a>(
        &self,
        program: Program,
        shader: Shader,
        textured: bool,
        listed: Listed<'a>,
        wavelengths: &'a [f32],
        tables: &Tables,
        out: &mut Out,
    ) {
        let (mut surfaces, mut materials) = (self.surfaces.view(), tables.materials);
        if let Some(queue) = self.textured.as_ref().filter(|_| textured) {
            let textured = queue.view();
            surfaces.material = textured.row;
            materials.parameters = textured.parameters;
        }
        let materials = &materials;
        let rows = Rows {
            listed,
            surfaces,
            drawn: self.drawn.view(),
            lit: self.lit.view(),
            smooth: self.smooth.as_ref().map(Queue::view),
            aligned: self.aligned.as_ref().map(Queue::view),
            wavelengths,
        };
        match shader {
            Shader::Plain | Shader::Medium | Shader::Mix => {
                unreachable!("they have no rows of their own")
            }
            Shader::Diffuse => with::<kinds::Diffuse>(program, rows, materials, out),
            Shader::RoughDiffuse => with::<kinds::RoughDiffuse>(program, rows, materials, out),
            Shader::SmoothConductor => {
                with::<kinds::SmoothConductor>(program, rows, materials, out);
            }
            Shader::RoughConductor => with::<kinds::RoughConductor>(program, rows, materials, out),
            Shader::SmoothDielectric => {
                with::<kinds::SmoothDielectric<false>>(program, rows, materials, out);
            }
            Shader::RoughDielectric => {
                with::<kinds::RoughDielectric<false>>(program, rows, materials, out);
            }
            Shader::SmoothDispersive => {
                with::<kinds::SmoothDielectric<true>>(program, rows, materials, out);
            }
            Shader::RoughDispersive => {
                with::<kinds::RoughDielectric<true>>(program, rows, materials, out);
            }
            Shader::Principled => {
                with::<kinds::Principled<false, false>>(program, rows, materials, out);
            }
            Shader::PrincipledGlass => {
                with::<kinds::Principled<true, false>>(program, rows, materials, out);
            }
            Shader::PrincipledDispersive => {
                with::<kinds::Principled<true, true>>(program, rows, materials, out);
            }
        }
    }
}

fn with<K: Kind>(program: Program, rows: Rows, materials: &Materials, out: &mut Out) {
    match program {
        Program::Mis => respond::<K, LightsWeighted>(rows, materials, out),
        Program::Light | Program::Blind { delta: true, .. } => {
            respond::<K, LightsAlone>(rows, materials, out);
        }
        _ => respond::<K, NoLights>(rows, materials, out),
    }
}
