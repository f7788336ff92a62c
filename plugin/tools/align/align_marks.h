// The picked pairs as the view shows them: marks with numbers, joined by lines.
#pragma once

namespace pcm::host {

class AlignSession;

// Replaces what is drawn; nothing is while the session is not shown.
void draw_marks(const AlignSession& session);
void show_marks(AlignSession& session, bool on);

}  // namespace pcm::host
