//! The library by its public interface: laws, known answers and comparisons with second
//! implementations, a file or a folder for each subject.
//!
//! One test program: each one more would compile the generic code of the library again.

mod any_scene;
mod architecture;
mod bricks;
mod cameras;
mod common;
mod comparators;
mod conventions;
mod core_set;
mod cost_orders;
mod cost_plots;
mod decide;
mod depth;
mod effects;
mod empty_images;
mod exact;
mod exchange;
mod film_noise;
mod flip_laws;
#[cfg(flip_oracle)]
mod flip_oracle;
#[cfg(not(flip_oracle))]
mod flip_oracle {
    #[test]
    fn flip_is_compared_with_that_of_nvidia() {
        let need = "a C++ compiler and RUSTFLAGS=\"--cfg flip_oracle\"";
        crate::needs::tried(false, need, "tests/library/flip_oracle.rs");
    }
}
mod flip_scale;
mod gate;
mod geometry_laws;
mod hard_laws;
mod honest_images;
mod image_meaning;
mod images;
mod kernel_precision;
mod known_answer_images;
mod known_answers_flip;
mod known_answers_statistics;
mod limit_ladders;
mod limits;
mod medium_known_answers;
mod medium_laws;
mod mesh_files;
mod meshes;
mod modes;
#[path = "../needs/mod.rs"]
mod needs;
mod outside_faults;
mod pinned_crates;
mod placement;
mod plain_english;
mod precision;
mod radiative_scenes;
mod ray_caster;
mod reference;
mod report;
mod reported;
mod sampled;
mod scores;
mod sensitivity;
mod sentences;
mod several_volumes;
mod stochastic;
mod support;
mod tracking;
mod transport;
mod unstated_noise;
mod vectors;
mod volume_files;
mod volume_known_answers;
mod volume_laws;
mod words_of_failures;
