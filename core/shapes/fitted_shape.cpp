#include "pcm/shapes/fitted_shape.h"

#include <cstddef>

namespace pcm {

const char* name_of(FitIssue issue)
{
    static constexpr const char* names[] = {"none",         "too few points", "not finite",    "coincident",
                                            "collinear",    "coplanar",       "thin arc",      "no consensus",
                                            "out of range", "not converged",  "other surface", "uneven"};
    return names[static_cast<std::size_t>(issue)];
}

const char* name_of(FitVerdict verdict)
{
    static constexpr const char* names[] = {"good", "doubtful", "refused"};
    return names[static_cast<std::size_t>(verdict)];
}

void doubt(ShapeFit& fit, FitIssue issue, const std::string& message)
{
    if (fit.verdict != FitVerdict::good) return;
    fit.verdict = FitVerdict::doubtful;
    fit.issue = issue;
    fit.message = message;
}

}  // namespace pcm
