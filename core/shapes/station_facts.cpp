#include "pcm/shapes/station_facts.h"

#include "pcm/system/text.h"

namespace pcm {
namespace {

std::string given_text(const StationFacts& facts)
{
    return facts.registration > 0 ? "a registration within " + brief(facts.registration) + " as given" : "";
}

std::string text_without_source(const StationFacts& facts)
{
    const std::string given = given_text(facts);
    return given.empty() ? "the points do not say from which station they are: the +- contains their noise, not the "
                           "registration; give what is known of it"
                         : "the +- contains the noise and " + given;
}

std::string text_of_spread(const StationFacts& facts)
{
    return "stations differ by " + brief(facts.spread) + " here: the +- contains the noise and " +
           (facts.registration > facts.spread ? given_text(facts) : "this");
}

std::string text_of_stations(const StationFacts& facts)
{
    if (facts.source == StationSource::none) return text_without_source(facts);
    const std::string given = given_text(facts);
    const std::string seen =
        facts.stations == 1 ? "seen from 1 station" : "seen from " + std::to_string(facts.stations) + " stations";
    if (facts.freedom == 0)
        return seen + ", and nothing around it from several: the +- contains the noise" +
               (given.empty() ? ", not the registration; give what is known of it" : " and " + given);
    return seen + "; " + text_of_spread(facts);
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

std::string spread_text(const StationFacts& facts)
{
    if (facts.source == StationSource::none) return text_without_source(facts);
    if (facts.freedom > 0) return text_of_spread(facts);
    const std::string given = given_text(facts);
    return "no shape is seen from several stations: the +- contains the noise" +
           (given.empty() ? ", not the registration; give what is known of it" : " and " + given);
}

}  // namespace pcm
