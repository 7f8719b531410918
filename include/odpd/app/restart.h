#pragma once
// What a checkpoint knows of the case that it belongs to: the resolved case, and the contents of every file that it names. A
// restart reads nothing else.
#include "odpd/core/config.h"
#include "odpd/io/checkpoint_file.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Writes the texts of the case's files (Config::file_text) and the contents of the start file.
template <int D>
void save_inputs(const Config& config, const SceneSettings<D>& scene, CheckpointWriter& out);

/// Gives `config`, of which nobody has read a file yet, the texts of the checkpoint in place of those on disk. Throws
/// ConfigError naming a value that differs from the checkpoint's case, as far as that can be told before the case is read.
void take_file_texts(CheckpointReader& in, const Config& config);

/// Fills start_positions, start_species, start_bodies and the offset of a shear, where the scene starts from a file.
template <int D>
void take_start(CheckpointReader& in, SceneSettings<D>& scene);

/// Throws ConfigError naming the first value in which `config`, read by now, differs from the case of the checkpoint.
/// Title, run.duration, run.until, run.blow_up, [solver] (but not solver.hold_centre_of_mass), [output], [[check]] and the
/// names of files may.
void require_same_case(CheckpointReader& in, const Config& config);

}  // namespace odpd
