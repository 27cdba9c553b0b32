//! Valid scenes, studies and packings, which the mutations set out from.

use std::path::Path;
use std::sync::OnceLock;

use jamscope::run::run;
use jamscope::scene::Scene;

use super::scene_file;

/// Scenes: the built-in one with every field, and others for what is absent by default.
pub fn scenes() -> Vec<Vec<u8>> {
    let relaxers = "disk_count = 60\n\
        mixture = [{ radius = 0.5, share = 1.0 }, { radius = 0.7, share = 2.0 }]\n\
        [law.power_law]\nenergy_scale = 1.0\nexponent = 2.5\n\
        [preparation]\npressure_tolerance = 0.05\nrelaxer = { quasi_newton = { memory = 8, step_limit = 500 } }\n\
        [inflation]\nincrease = 0.2\ncentre = { label = 17 }\nboundary = \"periodic\"\non_site_coupling = 0.5\n\
        [[sample]]\nname = \"a\"\nseed = 2\nsource = { packing_fraction = 0.9 }\n\
        relaxer = { damped = { time_step = { fixed = 1e-3 }, step_limit = 900 } }\n\
        [[sample]]\nname = \"b\"\nsource = { pressure = 2000.0 }\n\
        relaxer = { conjugate_gradients = { largest_step = 0.1 } }\n\
        [[sample]]\nname = \"c\"\nsource = { file = \"packing.xyz\" }\n\
        relaxer = { fire = { limit = { absolute = 1e-7 }, mixing = 0.2 } }\n";
    let scenes = vec![scene_file::commented_scene(), relaxers.into()];
    #[cfg(feature = "linear")]
    let linear = vec![
        "disk_count = 100\n[law.hookean]\nstiffness = 1e5\n\
        [observables.protocol]\nfraction = 1.0\n[observables.plastic_part]\nring_width = 0.5\n\
        [[sample]]\nname = \"n\"\nsource = { pressure = 10.0 }\n\
        relaxer = { implicit = { damping = { viscoelastic = { rate = 500.0 } }, tolerance = 1e-3 } }\n\
        [[sample]]\nname = \"m\"\nsource = { pressure = 10.0 }\nrelaxer = { staged = { hand_over = 1e-5 } }\n"
            .to_string(),
    ];
    #[cfg(feature = "linear")]
    let scenes = [scenes, linear].concat();
    scenes.into_iter().map(String::into_bytes).collect()
}

/// Studies: lists, and parts.
pub fn studies() -> Vec<Vec<u8>> {
    let lists = "disk_counts = [100, 200]\ntargets = [{ pressure = 10.0 }, { packing_fraction = 0.82 }]\n\
        increases = [0.1, 0.2]\nlaws = [{ hertzian = { stiffness = 2e5 } }, { hookean = { stiffness = 1e4 } }]\n\
        relaxers = [{ fire = { step_limit = 1000 } }, { damped = {} }]\nseeds = { first = 1, count = 3 }\n\
        time_limit = 60.0\n[scene.inflation]\nboundary = { held_rim = { outer_radius_over_side = 0.45 } }\n\
        [scene.observables.radial_profile]\nring_width = 1.0\n";
    let parts = "targets = [{ reduced_pressure = 1e8 }]\nseeds = { first = 7, count = 2 }\n\
        [scene]\ndisk_count = 80\n[scene.preparation]\npressure_tolerance = 0.02\n\
        [[part]]\ndisk_counts = [60]\n[[part]]\ndisk_counts = [90]\nboundary = \"periodic\"\nseeds = { first = 1, count = 1 }\n";
    vec![lists.into(), parts.into()]
}

/// Packings in every format: those of a run with corrections and held disks, and those of LAMMPS.
pub fn packings() -> &'static [Vec<u8>] {
    static PACKINGS: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    PACKINGS.get_or_init(|| {
        let mut all = run_files();
        let formats = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/formats");
        for name in [
            "disks.data",
            "balls.data",
            "disks_wrapped.dump",
            "disks_scaled_unwrapped.dump",
            "disks_two_frames.dump",
            "balls_scaled.dump",
        ] {
            all.push(std::fs::read(formats.join(name)).expect("a fixture"));
        }
        // Columns that a run does not write.
        let columns = "3\nPBC = [T, T, T] note Properties=held:L:1:id:I:1:radius:R:1:pos:R:2:species:S:1:site:R:2:site_correction:R:2 \
            lattice='9 0 0 0 8 0 0 0 7' origin={-1 -2 0} law=hookean stiffness=3.0 dimension=2\n\
            F 7 .5 1. 2e0 Small 1 2 1e-17 0\nT 3 0.7 2.1 2 Large 2 2 0 0\nF 4 0.7 1.3 2.9 Large 1.3 2.9 0 -1e-17\n";
        all.push(columns.into());
        all
    })
}

/// The packings that a run of a few disks writes: in its box, before the inflation, and after it.
pub fn run_files() -> Vec<Vec<u8>> {
    let scene = Scene::from_toml(
        "disk_count = 60\n[observables.displacement_field]\n[[sample]]\nname = \"a\"\nseed = 2\nsource = { packing_fraction = 0.95 }\n",
    )
    .expect("a valid scene");
    let report = run(&scene, &()).expect("a scene that runs");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut files = jamscope::report::write(&report, folder.path()).expect("a folder to write to");
    files.retain(|file| file.extension().is_some_and(|extension| extension == "xyz"));
    files.sort();
    assert!(files.len() >= 3, "{files:?}");
    files.iter().map(|file| std::fs::read(file).expect("a file of the run")).collect()
}
