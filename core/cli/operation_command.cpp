#include "pcm/cli/operation_command.h"

#include "pcm/cli/common.h"
#include "pcm/ops/shared/chain.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    explicit Arguments(const ops::Row& row) : operation(row.make()) {}
    Common common;
    std::unique_ptr<ops::Operation> operation;
};

int run(const ops::Row& row, Arguments& arguments, const OpenGLSetup& set_up_opengl,
        const std::vector<std::string>& words)
{
    ops::Context context;
    context.progress = console_progress(arguments.common);
    set_up_opengl(context, words);
    const ops::Result result = ops::run_on_files_too(row, *arguments.operation, context);
    end_progress(arguments.common);
    if (arguments.common.json) {
        print_json(ops::json_of(row.name, result));
    } else {
        for (const std::string& note : result.notes) std::printf("note: %s\n", note.c_str());
        for (const std::string& line : ops::all_lines(result)) std::printf("%s\n", line.c_str());
    }
    const int code = finished(result.outcome);
    return result.good ? code : 1;
}

}  // namespace

Command operation_command(const ops::Row& row, const OpenGLSetup& set_up_opengl)
{
    return {row.name, row.help,
            [&row, set_up_opengl](Options& options) -> Run {
                auto arguments = std::make_shared<Arguments>(row);
                for (ops::Argument& argument : arguments->operation->arguments().list())
                    if (argument.is_in(ops::Face::command)) options.argument(argument);
                add_common(options, arguments->common);
                return [&row, arguments, set_up_opengl, words = options.words()] {
                    return run(row, *arguments, set_up_opengl, words);
                };
            },
            row.limits ? row.limits : ""};
}

}  // namespace pcm::cli
