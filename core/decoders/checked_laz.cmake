# A copy of the crate laz in which a damaged file cannot overflow the stack.
#
# GPS times are in four sequences, and a symbol of the compressed stream switches to another of them. laz 0.13 handles such
# a switch by recursion, as often as the file contains it. No encoder switches twice without a time in between: in the copy
# the seventeenth switch in a row is an error.

# Sets ${text} to itself with `count` occurrences of `from` replaced by `to`, and ${why} when their number differs.
function(replace_exactly text count from to why)
  string(REPLACE "${from}" "" without "${${text}}")
  string(LENGTH "${${text}}" length)
  string(LENGTH "${without}" length_without)
  string(LENGTH "${from}" each)
  math(EXPR found "(${length} - ${length_without}) / ${each}")
  if(NOT found EQUAL count)
    set(${why} "the crate laz is not the one that is known: ${found} times, not ${count}, it has '${from}'" PARENT_SCOPE)
  endif()
  string(REPLACE "${from}" "${to}" replaced "${${text}}")
  set(${text} "${replaced}" PARENT_SCOPE)
endfunction()

# From the folder `laz` of the crate to the folder `copy`; sets ${why} when that fails.
function(make_checked_laz laz copy why)
  set(${why} "" PARENT_SCOPE)
  if(NOT EXISTS "${laz}/src/las/point6.rs" OR NOT EXISTS "${laz}/src/las/gps.rs")
    set(${why} "cargo does not say where the source of the crate laz is" PARENT_SCOPE)
    return()
  endif()
  set(wrong "")
  set(error "return Err(std::io::Error::new(
                            std::io::ErrorKind::InvalidData,
                            \"GPS times switch between their sequences without end\",
                        ))")

  # Point formats 6 to 10.
  file(READ ${laz}/src/las/point6.rs changed)
  replace_exactly(changed 1 "fn read_gps_time(&mut self) -> std::io::Result<()> {"
                  "fn read_gps_time(&mut self) -> std::io::Result<()> {
            self.read_gps_time_after(0)
        }

        fn read_gps_time_after(&mut self, switches: u32) -> std::io::Result<()> {
            if switches > 16 {
                ${error};
            }" wrong)
  replace_exactly(changed 2 "& 3;\n                    self.read_gps_time()?;"
                  "& 3;\n                    self.read_gps_time_after(switches + 1)?;" wrong)
  file(CONFIGURE OUTPUT ${copy}/src/las/point6.rs CONTENT "@changed@" @ONLY)

  # Point formats 1, 3, 4 and 5.
  file(READ ${laz}/src/las/gps.rs changed)
  replace_exactly(changed 1 "multi_extreme_counters: [i32; 4],\n" "multi_extreme_counters: [i32; 4],\n        switches: u32,\n"
                  wrong)
  replace_exactly(changed 1 "multi_extreme_counters: [0i32; 4],\n"
                  "multi_extreme_counters: [0i32; 4],\n                switches: 0,\n" wrong)
  replace_exactly(changed 2 "self.decompress_with(&mut decoder, buf)?;"
                  "self.common.switches += 1;
                        if self.common.switches > 16 {
                            ${error};
                        }
                        self.decompress_with(&mut decoder, buf)?;
                        self.common.switches = 0;" wrong)
  file(CONFIGURE OUTPUT ${copy}/src/las/gps.rs CONTENT "@changed@" @ONLY)

  file(COPY ${laz}/ DESTINATION ${copy} PATTERN point6.rs EXCLUDE PATTERN gps.rs EXCLUDE)
  set(${why} "${wrong}" PARENT_SCOPE)
endfunction()
