// A parameter of MeshLab's that is a choice, in any generation of MeshLab.
#pragma once

#include "plugin/meshlab/meshlab.h"

namespace pcm::test {

// Null: the list has no choice of this name.
inline const RichEnum* find_choice(const RichParameterList& parameters, const QString& name)
{
    return parameters.hasParameter(name) ? dynamic_cast<const RichEnum*>(&parameters.getParameterByName(name))
                                         : nullptr;
}

inline void choose(RichParameterList& parameters, const RichEnum& choice, int number)
{
    parameters.setValue(choice.name(), RichEnum(choice.name(), number, choice.enumvalues, "", "").value());
}

}  // namespace pcm::test
