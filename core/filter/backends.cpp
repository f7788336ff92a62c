#include "pcm/filter/backends.h"

#include "pcm/knn/flann_search.h"

namespace pcm {

bool offers_flann() { return has_flann(); }

}  // namespace pcm
