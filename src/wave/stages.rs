//! The stages of the loop: each runs its kernel over the wave's queues and books what it did.

use super::account::Stage;
use super::branch::{Met, Slots};
use super::generate::Source;
use super::media::{self, Gone};
use super::sampling::with_sampler;
use super::shutter::ShadowTimes;
use super::sort::Wanted;
use super::surfaces::Surfaces;
use super::tally::Tally;
use super::{Wave, cast, intersect, roulette, shade, slowed, sort};
use crate::effects::Shader;
use crate::film::SampleBuffer;
use huygens_kernels::bare::{COMPLETE, called_for};
use huygens_kernels::cost::{Cost, item};
use huygens_kernels::emission::{SKY, SURFACE, UNOCCLUDED};
use huygens_kernels::light::{VARIED, vary};
use huygens_kernels::queues::{Listed, PathHitsMut, PathsMut};
use huygens_kernels::rays::{CLOSEST, OCCLUSION};
use huygens_kernels::scatter::align::ALIGN;
use huygens_kernels::scatter::disperse::{DISPERSE, disperse};
use huygens_kernels::scatter::interact::INTERACT;
use huygens_kernels::scatter::light_up::LIGHT_UP;
use huygens_kernels::scatter::texture::TEXTURE;
use huygens_kernels::scatter::{Out, medium, plain, respond};
use huygens_kernels::{camera, roulette as roulette_kernel};

impl Wave<'_> {
    /// Starts camera rays where there is room, unless paths wait to branch.
    pub(super) fn generate(&mut self, source: &mut Source, slots: Slots) {
        if self.waits() {
            return;
        }
        let setup = self.setup;
        let new = source.refill(&setup.lens, setup.sampler, &mut self.paths, slots);
        if new > 0 {
            self.extras.start(self.paths.len() - new, new);
            let mut out = Tally::default();
            out.add(0, new);
            let cost = camera::COST * new;
            let nothing = Tally::default();
            self.account.book(Stage::Generate, &nothing, &out, cost);
            self.open_shutter(new);
        }
    }

    pub(super) fn intersect(&mut self, slots: Slots) {
        let account = &mut self.account;
        for _ in 0..slowed::times(Stage::Intersect) {
            intersect::intersect(
                self.setup.obstacles(self.extras.times()),
                &mut self.paths,
                &mut self.hits,
                |slot| {
                    account.lose_ray(Stage::Intersect.name(), slots.sample_of(slot));
                },
            );
        }
        let n = self.paths.len();
        self.traced = account.tally(&self.paths.view().bounces[..n]);
        account.book(Stage::Intersect, &self.traced, &self.traced, CLOSEST * n);
    }

    pub(super) fn sort(&mut self) {
        let (setup, n) = (self.setup, self.paths.len());
        let (paths, hits) = (self.paths.view(), self.hits.view());
        for _ in 0..slowed::times(Stage::Sort) {
            self.lists.sort(n, paths, hits, setup, setup.wanted);
        }
        if !self.account.counts() {
            return;
        }
        let listed = self.lists.tally();
        let cost = sort::READ * n + sort::WRITTEN * listed.total();
        self.account.book(Stage::Sort, &self.traced, &listed, cost);
    }

    /// Adds the light that paths find by themselves.
    pub(super) fn emit(&mut self, slots: Slots, samples: &mut SampleBuffer) {
        let (program, tables) = (self.setup.program, &self.setup.tables);
        let (paths, hits) = (self.paths.view(), self.hits.view());
        let account = &mut self.account;
        let nothing = Tally::default();
        let times = self.extras.times();
        let list = &self.lists.sky;
        if list.len() > 0 {
            shade::sky(program, list.of(paths, hits), tables, samples, |slot| {
                account.drop_sample(Stage::Sky.name(), slots.sample_of(slot));
            });
            account.book(Stage::Sky, &list.tally, &nothing, SKY * list.len());
        }
        let list = &self.lists.emission;
        if list.len() > 0 {
            let listed = Listed {
                times,
                ..list.of(paths, hits)
            };
            shade::emission(program, listed, tables, samples, |slot| {
                account.drop_sample(Stage::Emission.name(), slots.sample_of(slot));
            });
            let cost = SURFACE * list.len();
            account.book(Stage::Emission, &list.tally, &nothing, cost);
        }
    }

    /// Puts the next branches in the place of the paths at surfaces.
    pub(super) fn branch(&mut self) {
        let Some(branches) = &mut self.branches else {
            return;
        };
        let (setup, account) = (self.setup, &mut self.account);
        let scatter = self.lists.scatter.iter().map(|list| list.len());
        let arrived: usize = scatter.sum();
        let met = Met {
            paths: &mut self.paths,
            hits: &mut self.hits,
            extras: &mut self.extras,
        };
        branches.exchange(&self.lists, met);
        let (paths, hits) = (self.paths.view(), self.hits.view());
        let n = self.paths.len();
        self.lists.sort(n, paths, hits, setup, Wanted::SURFACES);
        let gone = account.tally(&paths.bounces[..n]);
        let row = item::<PathsMut<'static>>() + item::<PathHitsMut<'static>>();
        // To wait, and from there.
        let cost = Cost::new(row, row) * (arrived + n);
        account.book(Stage::Branch, &gone, &gone, cost);
    }

    /// Gives a wavelength to the paths that meet dispersive surfaces.
    pub(super) fn disperse(&mut self) {
        let Some(mut wavelengths) = called_for(self.extras.wavelengths_mut()) else {
            return;
        };
        let mut paths = self.paths.view_mut();
        let lists = self.setup.shaders.iter().zip(&self.lists.scatter);
        for (_, list) in lists.filter(|(s, list)| s.disperses() && list.len() > 0) {
            let (index, n) = (list.padded(), list.len());
            with_sampler!(self.setup.sampler, sampler => {
                disperse(index, n, sampler, &mut paths, &mut wavelengths);
            });
            self.account
                .book(Stage::Disperse, &list.tally, &list.tally, DISPERSE * n);
        }
    }

    /// Scatters paths and casts occlusion rays, one shader after the other.
    pub(super) fn scatter(&mut self, slots: Slots, samples: &mut SampleBuffer) {
        let setup = self.setup;
        let (program, tables, sampler) = (setup.program, &setup.tables, setup.sampler);
        let (paths, hits) = (self.paths.view(), self.hits.view());
        let (account, extras) = (&mut self.account, &self.extras);
        self.scattered_extras.clear();
        (self.went_on, self.cast) = (Tally::default(), Tally::default());
        let mut out = Out {
            paths: self.scattered.view_mut(),
            path_len: 0,
            shadows: self.shadows.view_mut(),
            shadow_len: 0,
        };
        for (k, &shader) in setup.shaders.iter().enumerate() {
            let list = &self.lists.scatter[k];
            if list.len() == 0 {
                continue;
            }
            let (stage, listed, tally) = (
                Stage::Scatter(shader),
                Listed {
                    times: extras.times(),
                    ..self.lists.scatter(k, paths, hits)
                },
                &list.tally,
            );
            let before = (out.path_len, out.shadow_len);
            let cost = match &mut self.surfaces {
                _ if COMPLETE && shader == Shader::Medium => {
                    let medium = extras.mediums().unwrap_or_default();
                    media::in_medium(program, listed, medium, tables, sampler, &mut out);
                    [medium::PATH, medium::SHADOW]
                }
                Some(surfaces) if COMPLETE && shader.has_rows() => {
                    for _ in 0..slowed::times(Stage::Interact) {
                        surfaces.interact(listed, tables, sampler);
                    }
                    account.book(Stage::Interact, tally, tally, INTERACT * list.len());
                    let textured = setup.textured[k].as_ref();
                    if let Some(layout) = textured {
                        surfaces.texture(listed, tables, layout);
                        account.book(Stage::Texture, tally, tally, TEXTURE * list.len());
                    }
                    if setup.aligned == Some(shader) {
                        surfaces.align(listed, tables);
                        account.book(Stage::Align, tally, tally, ALIGN * list.len());
                    }
                    if setup.lights(shader) {
                        surfaces.light_up(shader, tables);
                        account.book(Stage::Light, tally, tally, LIGHT_UP * list.len());
                    }
                    let textured = textured.is_some();
                    let light = extras.wavelengths();
                    surfaces.respond(program, shader, textured, listed, light, tables, &mut out);
                    [respond::PATH, respond::SHADOW]
                }
                _ => {
                    shade::plain(
                        program,
                        listed,
                        tables,
                        sampler,
                        &mut out,
                        samples,
                        |slot| {
                            account.drop_sample(stage.name(), slots.sample_of(slot));
                        },
                    );
                    [plain::SCATTER, plain::SHADOW]
                }
            };
            if out.path_len > before.0 {
                self.scattered_extras.append_rows(extras, list.indices());
            }
            let cast = before.1..out.shadow_len;
            if COMPLETE && (tables.media.is_some() || self.shadow_times.is_some()) {
                cast::rows_of(listed, &out.shadows.slot[cast.clone()], &mut self.rows);
            }
            if let Some(times) = called_for(self.shadow_times.as_mut()) {
                times.give(cast.clone(), listed, &self.rows);
            }
            if let (Some(media), Some(medium)) =
                (called_for(tables.media.as_ref()), extras.mediums())
            {
                let surfaces = self.surfaces.as_ref().filter(|_| shader.passes());
                let gone = Gone {
                    listed,
                    medium,
                    surfaces: surfaces.map(Surfaces::rows),
                };
                gone.attenuate(media, cast, &self.rows, &mut out.shadows);
                if let Some(into) = self.scattered_extras.mediums_mut() {
                    gone.cross(media, &out.paths, before.0, into);
                }
            }
            let on = account.tally(&out.paths.bounces[before.0..out.path_len]);
            let cast = account.tally(&out.shadows.bounces[before.1..out.shadow_len]);
            let cost = cost[0] * on.total() + cost[1] * cast.total();
            self.went_on.extend(&on);
            self.cast.extend(&cast);
            account.book(stage, tally, &on.plus(&cast), cost);
        }
        let (on, cast) = (out.path_len, out.shadow_len);
        if COMPLETE && cast > 0 && setup.runs(Stage::Vary) {
            vary(cast, &mut out.shadows, tables);
            account.book(Stage::Vary, &self.cast, &self.cast, VARIED * cast);
        }
        self.scattered.set_len(on);
        self.shadows.set_len(cast);
    }

    pub(super) fn occlude(&mut self, slots: Slots, samples: &mut SampleBuffer) {
        let n = self.shadows.len();
        if n == 0 {
            return;
        }
        let account = &mut self.account;
        let mut lost = Vec::new();
        intersect::occlude(
            self.setup
                .obstacles(self.shadow_times.as_ref().map(ShadowTimes::all)),
            slots,
            &mut self.shadows,
            &mut self.occlusion,
            samples,
            |slot| lost.push(slot),
            |slot| account.drop_sample(Stage::Occlude.name(), slots.sample_of(slot)),
        );
        for slot in lost {
            account.lose_ray(Stage::Occlude.name(), slots.sample_of(slot));
        }
        let cost = (OCCLUSION + UNOCCLUDED) * n;
        account.book(Stage::Occlude, &self.cast, &Tally::default(), cost);
    }

    pub(super) fn roulette(&mut self, slots: Slots) {
        let (setup, account) = (self.setup, &mut self.account);
        let scattered = &mut self.scattered;
        roulette::run(
            setup.carried.wavelengths,
            setup.rules,
            setup.sampler,
            scattered,
            &mut self.kept,
            &mut self.paths,
            |slot| account.drop_sample(Stage::Roulette.name(), slots.sample_of(slot)),
        );
        self.extras.clear();
        self.extras.append_kept(&self.scattered_extras, &self.kept);
        let (n, survivors) = (self.scattered.len(), self.paths.len());
        if n == 0 {
            return;
        }
        let left = account.tally(&self.paths.view().bounces[..survivors]);
        let moved = item::<PathsMut<'static>>();
        let cost =
            (roulette_kernel::COST + Cost::new(moved, 0)) * n + Cost::new(0, moved) * survivors;
        account.book(Stage::Roulette, &self.went_on, &left, cost);
    }

    pub(super) fn commit(&mut self, samples: usize, left_out: &[(u32, u32, u32)]) {
        for &at in left_out {
            self.account.drop_sample("film", at);
        }
        let mut tally = Tally::default();
        tally.add(0, samples);
        let cost = SampleBuffer::COST * samples;
        self.account
            .book(Stage::Film, &tally, &Tally::default(), cost);
    }
}
