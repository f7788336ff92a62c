// Layers of drawings with a layer per thing.
#pragma once

#include <string>
#include <vector>

namespace pcm {

// A name for each that a layer may have, all different, in capital letters too, and none "0" or "Defpoints", which
// programs have already: "Wall", "Wall (2)". Characters that no layer's name may have become "_", others beyond ASCII
// stay. At most 255 characters as dxf_text() writes them.
std::vector<std::string> layer_names(const std::vector<std::string>& names);
// The same for names that are typed: letters, digits, "-", "_" and "$" of ASCII alone. Letters of Latin, Greek and
// Cyrillic are written with those ("Rohr", "Truba"), other letters by their number ("U4E2D"), so that names stay apart.
std::vector<std::string> plain_layer_names(const std::vector<std::string>& names);

}  // namespace pcm
