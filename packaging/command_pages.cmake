# Writes the manual pages of a program and its completion for the shells below a folder, as they lie in /usr/share.
#
#     cmake -D PROGRAM=bin/pcmlab -D OUTPUT=FOLDER -P command_pages.cmake

function(ask file)  # the rest: words of the command line
  execute_process(COMMAND ${PROGRAM} help ${ARGN} OUTPUT_FILE ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${OUTPUT})
file(MAKE_DIRECTORY ${OUTPUT}/man/man1 ${OUTPUT}/bash-completion/completions ${OUTPUT}/zsh/site-functions)
ask(${OUTPUT}/bash-completion/completions/pcmlab --completion bash)
ask(${OUTPUT}/zsh/site-functions/_pcmlab --completion zsh)
execute_process(COMMAND ${PROGRAM} help --json OUTPUT_VARIABLE usage COMMAND_ERROR_IS_FATAL ANY)
string(JSON count LENGTH "${usage}" commands)
math(EXPR last "${count} - 1")
foreach(i RANGE ${last})
  string(JSON name GET "${usage}" commands ${i} name)
  ask(${OUTPUT}/man/man1/pcmlab-${name}.1 --man ${name})
endforeach()
ask(${OUTPUT}/man/man1/pcmlab.1 --man)
