#include "pcm/shapes/station_facts.h"

#include "pcm/system/text.h"

namespace pcm {
namespace {

std::string text_of_stations(const StationFacts& facts)
{
    const std::string given =
        facts.registration > 0 ? "a registration within " + brief(facts.registration) + " as given" : "";
    if (facts.source == StationSource::none)
        return given.empty() ? "the points do not say from which station they are: the +- contains their noise, not "
                               "the registration; give what is known of it"
                             : "the +- contains the noise and " + given;
    const std::string seen =
        facts.stations == 1 ? "seen from 1 station" : "seen from " + std::to_string(facts.stations) + " stations";
    if (facts.freedom == 0)
        return seen + ", and nothing around it from several: the +- contains the noise" +
               (given.empty() ? ", not the registration; give what is known of it" : " and " + given);
    return seen + "; stations differ by " + brief(facts.spread) + " here: the +- contains the noise and " +
           (facts.registration > facts.spread ? given : "this");
}

}  // namespace

const char* name_of(StationSource source)
{
    switch (source) {
        case StationSource::attribute:
            return "attribute";
        case StationSource::time_gaps:
            return "time gaps";
        default:
            return "none";
    }
}

std::string station_text(const StationFacts& facts)
{
    std::string text = text_of_stations(facts);
    if (facts.ray_share > 0) text += "; and what may be left of errors along the scanner's rays";
    return text;
}

}  // namespace pcm
