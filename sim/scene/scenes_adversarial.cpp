// Scenes that are hard on ranking: exactly flat, up and down at every sample, toggling between two sensor steps.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scenes.hpp"

namespace scansion {
namespace {

Scene plate(const char* name, const char* summary) {
  Scene scene;
  scene.name = name;
  scene.summary = summary;
  scene.length_x = 102.4;
  scene.length_y = 12.8;
  scene.lines = 64;
  scene.points = 4096;
  scene.noise_um = 0.0;
  return scene;
}

} // namespace

Scene make_flat() {
  return plate("flat", "exactly flat plate without noise: every distance is zero");
}

Scene make_zigzag() {
  Scene scene = plate("zigzag", "up and down by 1 mm from sample to sample: ties everywhere");
  scene.texture = Texture::zigzag;
  scene.texture_um = 1000.0;
  return scene;
}

Scene make_two_step() {
  Scene scene = plate("two-step", "plate that toggles at random between two sensor steps of 5 um");
  scene.texture = Texture::two_step;
  scene.texture_um = 5.0;
  return scene;
}

} // namespace scansion
