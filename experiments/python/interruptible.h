// experiments/python/interruptible.h — native work that leaves the interpreter to others, and that Ctrl-C ends.
#pragma once
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/stop.h"
#include "experiments/cli/command.h"
#include "experiments/cli/program.h"
#include "experiments/python/bridge.h"

namespace lensproof::python {

/// Throws the exception `name` of the package's module `errors`.
[[noreturn]] inline void throw_python(const char* name, const std::string& message) {
    PyObject* const errors = PyImport_ImportModule("lensproof.errors");
    PyObject* const kind = errors != nullptr ? PyObject_GetAttrString(errors, name) : nullptr;
    if (kind != nullptr) {
        PyErr_SetString(kind, message.c_str());
    }
    Py_XDECREF(kind);
    Py_XDECREF(errors);
    throw PythonError();
}

/// What work() returns. It runs on a thread of its own, without the interpreter's lock, while this one waits for it and
/// lets Python handle signals: where a handler raises, as that of Ctrl-C does, the work is asked to stop
/// (engine/base/stop.h), and what was raised is thrown when it has. What fails otherwise becomes the package's errors.
template <class Work>
auto interruptible(const Work& work) {
    constexpr auto kLook = std::chrono::milliseconds(50);
    std::atomic<bool> stop = false;
    std::exception_ptr raised;
    std::optional<decltype(work())> value;
    std::future<cli::Outcome> result = std::async(std::launch::async, [&] {
        const StopScope scope(&stop);
        return cli::outcome_of([&] {
            value.emplace(work());
            return cli::kDone;
        });
    });
    {
        const bridge::gil_scoped_release unlocked;
        while (result.wait_for(kLook) != std::future_status::ready) {
            const bridge::gil_scoped_acquire locked;
            if (!stop && PyErr_CheckSignals() != 0) {
                raised = std::make_exception_ptr(PythonError());
                stop = true;
            }
        }
    }
    cli::Outcome outcome;
    try {
        outcome = result.get();
    } catch (const Stopped&) {
    }
    if (raised) {
        std::rethrow_exception(raised);
    }
    if (!outcome.message.empty()) {
        throw_python(outcome.status == cli::kUnusableInput ? "InputError" : "LensproofError", outcome.message);
    }
    return *std::move(value);
}

}  // namespace lensproof::python
