// Writes the tree of the moving layer where the picked pairs put it, in double.
#pragma once

#include <QString>

#include <functional>

namespace pcm::host {

class AlignSession;

// A free name next to the moving layer's tree: NAME-aligned.pct.
QString proposed_tree(const AlignSession& session);

// Writes the tree `file`, shows it in a new layer and hides the moving layer. `say` gets the progress and what was
// done. Esc cancels it. Throws Error(invalid_argument) without a fit or for an ordinary layer, Error(exists) where
// there is something of this name, Error(cancelled), and what building a tree throws.
void write_moved_layer(AlignSession& session, const QString& file, const std::function<void(const QString&)>& say);

}  // namespace pcm::host
