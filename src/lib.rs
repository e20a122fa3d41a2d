//! volref: a reference renderer for volumes, and a harness that tests other renderers against it.
//!
//! volref provides the correct image of a scene, and decides whether the image of another renderer
//! differs from it.
//!
//! **Read [`reference::ray_caster`] first, then [`reference::path_tracer`]:** the two reference
//! renderers, deliberately straightforward. [`render`] holds the fast renderers, which
//! are tested against them. [`guide`] is the manual of the commands.
//!
//! # Equations
//!
//! **Classified volumes** (direct volume rendering, after Levoy 1988 and Max 1995). A ray through
//! the centre of each pixel is sampled at the midpoints of steps of length `h`. At sample `i` the
//! density `d_i` is interpolated from a grid and classified:
//!
//! ```text
//! a_i = 1 − T(d_i)^(h/h0)               opacity of the step, T the transparency over h0
//! L_i = d_i² · shade(colormap(d_i)) · v_i      radiance, v_i the light that arrives
//! C   = Σ_i a_i · L_i · Π_{j<i} (1 − a_j)       what the eye sees
//! ```
//!
//! With a table of points in place of the formula ([`optics::TransferPoints`]), opacity and colour
//! are read from the table and the factor `d²` is left out: `L_i = shade(colour(d_i)) · v_i`.
//! As `h` becomes short the sum converges to an integral, which a scene may ask for itself
//! ([`render::classified::integral`]). The sum is evaluated front to back or back to front ([`optics::Layer`]); `T` is in
//! [`optics::TransferOpacity`], shading in [`optics::Phong`], `v` in [`render::classified::ray_caster`].
//!
//! In place of composited samples a scene may show a number for each ray, such as the largest value, or surfaces of
//! equal value ([`reference::projection`], [`reference::isosurface`], [`render::classified::modes`]).
//!
//! **Participating media** (radiative transfer, Chandrasekhar 1950). Along a ray from `x` in
//! direction `−ω`, up to a surface at distance `s`:
//!
//! ```text
//! L(x, ω) = ∫₀^s T(t) [ j + σ_s ∫ p(cos θ) L(x_t, ω') dω' ] dt  +  T(s) L_surface
//! T(t)    = exp(−∫₀^t σ_t dt'),  σ_t = σ_a + σ_s
//! ```
//!
//! with `j` the emission and `p` the phase function; the surface emits, reflects and refracts
//! light. The equation is solved by the cheapest method that is exact for the scene: closed forms
//! and integrals along the line of sight ([`render::radiative::line_of_sight`]), else path tracing
//! ([`render::radiative::path_tracer`]). The coefficients of a heterogeneous medium are constants
//! multiplied by a density field ([`volume::DensityField`]), and paths are sampled by tracking
//! ([`render::radiative::tracking`]).
//!
//! # Conventions
//!
//! - Right-handed, y up; looking along +z, +x points left in the image.
//! - Lengths in world units, angles in degrees in files and radians in code.
//! - Radiance is linear RGB. EXR stores it unchanged; PNG is a preview, sRGB encoded at a stated
//!   exposure. Images are stored top row first.
//! - Phase functions: `θ` is the angle between the directions of travel before and after; `g > 0`
//!   is forward. Coefficients are per world unit.
//! - Pixels: the radiance through the centre where no random numbers are needed, else the mean over
//!   the pixel's area (box filter).
//! - Grids are node-centred, x fastest; interpolation is `a + (b − a)·t`. *One voxel* as a length
//!   is the smallest distance between neighbouring nodes.
//! - Sample positions follow from an index, `t0 + (i + ½)·h`; the last step ends at the end of the
//!   span.
//! - Nothing is skipped unless it is exactly zero, and there is no absolute epsilon anywhere:
//!   scaling all lengths by a power of two gives a bit-identical image.
//! - **Same bits everywhere**: for any number of threads, debug or release, any platform.
//!   Transcendental functions come from [`math`] alone, which forwards to a pinned `libm`.
//!
//! # Modules
//!
//! `ARCHITECTURE.md` in the repository is the map. In short: [`scene`] reads a file, [`render::plan`]
//! chooses the code for it with reasons, [`render`] computes the image, which [`mod@reference`]
//! computes plainly; [`suite`] holds cases and goldens, [`compare`] judges two images, [`judging`] gives
//! verdicts on cases, [`naming`] searches the mistake or convention behind a failing image.
//! Tests of other renderers start at [`check`].
//!
//! ```no_run
//! use volref::render::{Sampling, plans, render};
//! use volref::scene::Scene;
//!
//! let scene = Scene::load("fixtures/scenes/figures/figure-3.toml".as_ref())?;
//! let image = render(&plans(&scene), Sampling::default(), &|| {})?.film;
//! std::fs::write("figure-3.png", image.to_png(1.0))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod check;
pub mod cli;
pub mod compare;
pub mod conventions;
pub mod cost;
pub mod exchange;
pub mod faulty_tracer;
mod files;
pub mod film;
pub mod geometry;
pub mod guide;
pub mod judging;
pub mod known_answers;
pub mod math;
pub mod naming;
pub mod optics;
pub mod reference;
pub mod render;
mod renderers;
pub mod report;
pub mod scene;
pub mod sensitivity;
pub mod suite;
pub mod variations;
pub mod volume;
