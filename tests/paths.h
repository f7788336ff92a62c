// Where this build has put what tests need. Known to one generated source alone, so that the tests themselves compile
// to the same objects wherever the project lies.
#pragma once

namespace pcm::paths {

extern const char* const sample_clouds;  // the folder; tests skip where it is absent
extern const char* const command;        // the program pcmlab
extern const char* const faults;         // the library that lets system calls fail (tests/faults)

}  // namespace pcm::paths
