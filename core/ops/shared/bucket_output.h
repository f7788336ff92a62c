// The output of an operation that writes a tree, which may be an address in a bucket.
#pragma once

#include "pcm/system/progress.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pcm::ops {

class BucketOutput {
public:
    // Throws what refuse_upload() throws where `output` is an address.
    BucketOutput(const std::string& output, const std::vector<std::string>& inputs, bool overwrite);

    bool is_address() const { return is_address_; }
    // Where the tree is written first: the output itself, or, for an address, NAME.upload.pct next to the first input
    // that is on this machine, or else in the folder for temporary files. Such a tree, of an earlier upload that
    // failed, may be replaced.
    const std::filesystem::path& place() const { return place_; }
    bool may_replace() const { return overwrite_ || is_address_; }

    // Sends the tree there to the address and removes it here; nothing where the output is a path. An error says
    // where the tree is and how it is sent again.
    void send(const ProgressFunction& progress) const;
    // The same of a tree that stays. Returns the bytes sent.
    std::uint64_t send(const std::filesystem::path& tree, const ProgressFunction& progress) const;

private:
    std::string output_;
    std::filesystem::path place_;
    bool is_address_, overwrite_;
};

}  // namespace pcm::ops
