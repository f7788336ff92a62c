#include "pcm/build/bins/reader_facts.h"

namespace pcm {

void take_reader_facts(const FileInfo& info, Ingested& found)
{
    found.notes.insert(found.notes.begin(), info.notes.begin(), info.notes.end());
    found.metadata = info.metadata;
    found.skipped = info.skipped;
    set_decimals(found.metadata, found.decimals);
    // Points that the reader was asked to leave out were read as well.
    found.points_in += info.points_left_out;
    found.points_skipped += info.points_left_out;
}

}  // namespace pcm
