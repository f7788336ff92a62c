// Reads a cloud with the project's reader and writes the result: one line of JSON on the standard output, and the
// columns as raw little endian numbers in a folder, so that other readers' results can be compared with them.
//
//     dump_cloud FILE            reads all of it and describes it
//     dump_cloud FILE FOLDER     also writes FOLDER/positions (x y z double), FOLDER/grid (x y z i32, when gridded) and
//                                FOLDER/0, 1, ... (attributes in the order of the line)
//
// An error is printed to the standard error, with exit code 1.
#include "pcm/io/reader.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

using Json = nlohmann::ordered_json;

class Columns {
public:
    Columns(const std::filesystem::path& folder, const pcm::FileInfo& info) : folder_(folder)
    {
        open("positions");
        if (info.grid) open("grid");
        for (std::size_t i = 0; i < info.schema.size(); ++i) open(std::to_string(i));
    }

    void write(const pcm::PointBatch& batch, const pcm::FileInfo& info)
    {
        std::size_t file = 0;
        std::vector<double> positions(batch.size * 3);
        for (std::size_t i = 0; i < batch.size; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                positions[i * 3 + a] = batch.gridded ? info.grid->to_source(batch.grid_xyz[a][i], a) : batch.xyz[a][i];
        put(file++, positions.data(), positions.size() * sizeof(double));
        if (info.grid) {
            std::vector<std::int32_t> grid(batch.size * 3);
            for (std::size_t i = 0; i < batch.size; ++i)
                for (std::size_t a = 0; a < 3; ++a) grid[i * 3 + a] = batch.grid_xyz[a][i];
            put(file++, grid.data(), grid.size() * sizeof(std::int32_t));
        }
        for (const pcm::Column& column : batch.attributes) put(file++, column.data(), column.bytes());
    }

    void close()
    {
        for (std::ofstream& file : files_) {
            file.close();
            if (!file) throw std::runtime_error("cannot write into " + folder_.string());
        }
    }

private:
    void open(const std::string& name)
    {
        files_.emplace_back(folder_ / name, std::ios::binary);
        if (!files_.back()) throw std::runtime_error("cannot make " + (folder_ / name).string());
    }
    void put(std::size_t file, const void* bytes, std::size_t count)
    {
        files_[file].write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    }

    std::filesystem::path folder_;
    std::vector<std::ofstream> files_;
};

Json described(const pcm::FileInfo& info)
{
    Json json;
    json["format"] = info.format;
    json["promised"] = info.points;
    json["position_type"] = pcm::name_of(info.position_type);
    json["grid"] = nullptr;
    if (info.grid) json["grid"] = {{"scale", info.grid->scale}, {"offset", info.grid->offset}};
    json["attributes"] = Json::array();
    for (const pcm::Attribute& attribute : info.schema)
        json["attributes"].push_back({{"name", attribute.name},
                                      {"type", pcm::name_of(attribute.type)},
                                      {"components", attribute.components},
                                      {"scale", attribute.scale},
                                      {"offset", attribute.offset}});
    json["notes"] = info.notes;
    return json;
}

int dump(const std::filesystem::path& file, const std::filesystem::path* folder)
{
    const auto reader = pcm::open_reader(file);
    const pcm::FileInfo& info = reader->info();
    std::vector<Columns> columns;
    if (folder) columns.emplace_back(*folder, info);

    std::uint64_t points = 0;
    for (pcm::PointBatch batch; reader->read(batch, pcm::default_batch_points);) {
        points += batch.size;
        if (folder) columns[0].write(batch, info);
    }
    if (folder) columns[0].close();

    Json json = described(info);  // after reading, which may add notes
    json["points"] = points;
    std::printf("%s\n", json.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
    return 0;
}

}  // namespace

int main(int count, char** arguments)
{
    if (count != 2 && count != 3) {
        std::fprintf(stderr, "usage: dump_cloud FILE [FOLDER]\n");
        return 2;
    }
    try {
        const std::filesystem::path folder = count == 3 ? arguments[2] : "";
        return dump(arguments[1], count == 3 ? &folder : nullptr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
