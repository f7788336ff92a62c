#include "bench/sweep/sweep.h"

#include "pcm/detect/tuned_values.h"
#include "pcm/fit/tuned_values.h"
#include "pcm/gl/tuned_values.h"
#include "pcm/knn/tuned_values.h"
#include "pcm/piping/tuned_values.h"
#include "pcm/place/tuned_values.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <sstream>
#include <stdexcept>

namespace pcm::bench {
namespace {

// One is restored however its sweep ends.
class Restored {
public:
    explicit Restored(const TunedValue& tuned) : tuned_(tuned), before_(tuned.get()) {}
    ~Restored() { tuned_.set(before_); }
    Restored(const Restored&) = delete;
    Restored& operator=(const Restored&) = delete;

private:
    const TunedValue tuned_;
    const double before_;
};

double number(const std::string& text, const std::string& sweep)
{
    std::size_t end = 0;
    double value = 0;
    try {
        value = std::stod(text, &end);
    } catch (const std::exception&) {
        end = 0;
    }
    if (end == 0 || end != text.size())
        throw std::invalid_argument("'" + sweep + "' is not NAME or NAME=FROM:TO:STEPS; '" + text +
                                    "' is not a number");
    return value;
}

std::vector<double> even_values(const std::string& range, const std::string& sweep)
{
    std::vector<double> parts;
    std::stringstream stream(range);
    for (std::string part; std::getline(stream, part, ':');) parts.push_back(number(part, sweep));
    if (parts.size() != 3 || parts[2] < 2 || parts[2] > 1000)
        throw std::invalid_argument("'" + sweep + "' is not NAME or NAME=FROM:TO:STEPS with 2 to 1000 steps");
    std::vector<double> values;
    for (int i = 0; i < static_cast<int>(parts[2]); ++i)
        values.push_back(parts[0] + (parts[1] - parts[0]) * i / (static_cast<int>(parts[2]) - 1));
    return values;
}

void print_row(const std::vector<std::string>& cells)
{
    for (const std::string& cell : cells) std::printf("| %s ", cell.c_str());
    std::printf("|\n");
    std::fflush(stdout);
}

}  // namespace

std::vector<TunedValue> tuned_values()
{
    std::vector<TunedValue> all;
    for (const auto& room : {fit_tuned_values(), place_tuned_values(), detect_tuned_values(), piping_tuned_values(),
                             knn_tuned_values(), gl_tuned_values()})
        all.insert(all.end(), room.begin(), room.end());
    return all;
}

Sweep read_sweep(const std::string& text)
{
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    for (const TunedValue& tuned : tuned_values()) {
        if (name != tuned.name()) continue;
        std::vector<double> values;
        if (equals == std::string::npos)
            for (const double factor : {0.5, 0.7, 0.85, 1.2, 1.4, 2.0}) values.push_back(factor * tuned.get());
        else
            values = even_values(text.substr(equals + 1), text);
        if (tuned.is_count())
            for (double& value : values) value = std::max(0.0, std::round(value));
        // An even value may be the present one up to rounding.
        values.erase(std::remove_if(
                         values.begin(), values.end(),
                         [&](double value) { return std::fabs(value - tuned.get()) <= 1e-9 * std::fabs(tuned.get()); }),
                     values.end());
        values.push_back(tuned.get());
        std::sort(values.begin(), values.end());
        values.erase(std::unique(values.begin(), values.end()), values.end());
        return {tuned, values};
    }
    throw std::invalid_argument("there is no tuned value '" + name + "': --sweep list prints the names");
}

std::string text_of_value(double value)
{
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
}

void print_sweep(const Sweep& sweep, const std::vector<std::string>& heads,
                 const std::function<std::vector<std::string>()>& figures)
{
    const Restored restored(sweep.tuned);
    const double before = sweep.tuned.get();
    std::vector<std::string> head{sweep.tuned.name()};
    head.insert(head.end(), heads.begin(), heads.end());
    head.push_back("CPU s");
    print_row(head);
    print_row(std::vector<std::string>(head.size(), "---:"));
    for (const double value : sweep.values) {
        sweep.tuned.set(value);
        const std::clock_t start = std::clock();
        std::vector<std::string> row = figures();
        const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        const std::string text = text_of_value(value);
        row.insert(row.begin(), value == before ? "**" + text + "**" : text);
        char cell[32];
        std::snprintf(cell, sizeof(cell), "%.1f", seconds);
        row.push_back(cell);
        print_row(row);
    }
    std::printf("\n");
}

std::vector<Sweep> read_sweeps(const std::vector<std::string>& texts)
{
    std::vector<Sweep> sweeps;
    if (texts == std::vector<std::string>{"list"}) {
        for (const TunedValue& tuned : tuned_values())
            std::printf("%s = %s\n", tuned.name(), text_of_value(tuned.get()).c_str());
        return sweeps;
    }
    for (const std::string& text : texts) sweeps.push_back(read_sweep(text));
    return sweeps;
}

}  // namespace pcm::bench
