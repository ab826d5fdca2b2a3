#include "cuda_features.h"

#include <cuda_profiler_api.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include "comparison.h"
#include "crumple/crumple.h"
#include "device_array.h"
#include "step.h"

namespace crumple::benchmark {
namespace {

DeviceArray copied(const io::TriangleMesh& mesh) {
    return std::visit([](const auto& v) { return DeviceArray(v.data(), v.size() * sizeof(v[0])); }, mesh.vertices);
}

/// Copy of a step on the device, with the stream on which its queries are launched.
class DeviceStep {
   public:
    explicit DeviceStep(const Step& step)
        : start_(copied(step.start)),
          end_(copied(step.end)),
          triangles_(step.start.triangles.data(), step.start.triangles.size() * sizeof(std::int32_t)),
          view_(step.start.view()),
          end_view_(step.end_view()) {
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking));
        for (cudaEvent_t* event : {&begin_event_, &end_event_}) check(cudaEventCreate(event));
        view_.vertices.data = start_.data();
        view_.triangles.data = triangles_.data();
        view_.memory = MemorySpace::cuda;
        view_.stream = stream_;
        end_view_.data = end_.data();
    }
    DeviceStep(const DeviceStep&) = delete;
    DeviceStep& operator=(const DeviceStep&) = delete;
    ~DeviceStep() {
        for (cudaEvent_t event : {begin_event_, end_event_}) cudaEventDestroy(event);
        cudaStreamDestroy(stream_);
    }
    const MeshView& view() const { return view_; }
    const VertexView& end() const { return end_view_; }

    /// Returns the milliseconds that the device spends on the work that launch() enqueues. A kernel keeps the stream
    /// busy until the work is enqueued, so that the time does not include the host's launch.
    template <class Launch>
    double milliseconds(Launch launch) const {
        keep_busy(stream_);
        check(cudaEventRecord(begin_event_, stream_));
        const auto launched = launch();
        check(cudaEventRecord(end_event_, stream_));
        launched.wait();
        check(cudaEventSynchronize(end_event_));
        float milliseconds = 0;
        check(cudaEventElapsedTime(&milliseconds, begin_event_, end_event_));
        return static_cast<double>(milliseconds);
    }

   private:
    DeviceArray start_, end_, triangles_;
    MeshView view_;
    VertexView end_view_;
    cudaStream_t stream_ = nullptr;
    cudaEvent_t begin_event_ = nullptr, end_event_ = nullptr;
};

template <class T>
bool same(const T* device, const Array<T>& host) {
    std::vector<T> copy(host.size());
    if (!copy.empty()) check(cudaMemcpy(copy.data(), device, copy.size() * sizeof(T), cudaMemcpyDeviceToHost));
    return std::equal(copy.begin(), copy.end(), host.begin(), host.end());
}
bool same_list(const DeviceImpactList& there, const ImpactList& here) {
    return same(there.pairs, here.pairs) && same(there.toi, here.toi);
}
bool same_list(const DeviceProximityList& there, const ProximityList& here) {
    return same(there.pairs, here.pairs) && same(there.squared_distance, here.squared_distance);
}
bool same_list(const DeviceCandidateList& there, const CandidateList& here) { return same(there.pairs, here.pairs); }

/// Returns a sentence about the first difference of a result on the device (`there`, by the cuda backend) and one on
/// the host (`here`, by the cpu backend); empty if there is none.
template <class There, class Here>
std::string difference(const There& there, const Here& here) {
    if (there.count != here.count) return fmt::format("cuda has {} rows, cpu has {}", there.count, here.count);
    if constexpr (std::is_same_v<There, DeviceImpacts>)
        if (!(there.first == here.first)) return "the first impacts differ";
    for (std::size_t k = 0; k < here.lists.size(); ++k)
        if (!same_list(there.lists[k], here.lists[k])) return fmt::format("the lists of kind {} differ", k);
    return "";
}

}  // namespace

Table table_of_steps() {
    return {"features of steps on the device, milliseconds",
            {"step", "query", "triangles", "rows", "device", "quartiles", "with wait", "cpu", "first"}};
}

void measure_step(const std::string& name, const Options& options, int frames, Table& table, const RowSink& add) {
    const Step step = load_step(name);
    const MeshView here = step.start.view();
    const VertexView end_here = step.end_view();
    const DeviceStep there(step);
    Detector cpu({.backend = Backend::cpu});
    const auto measure = [&](const char* what, const Scene& on_device, const Scene& on_host, const auto& query) {
        Detector detector(options);
        const auto launch = [&] { return detector.launch(on_device, query); };
        const auto find = [&]() -> const auto& { return cpu.find(on_host, query); };
        const auto frame = [&] { return there.milliseconds(launch); };
        const double first = milliseconds_of(frame);
        for (int warm_up = 0; warm_up < 5; ++warm_up) frame();
        std::vector<double> device;
        for (int i = 0; i < frames; ++i) device.push_back(frame());
        const Summary by_events = summarise(std::move(device));
        const Summary clock = repeated(frames, [&] { launch().wait(); });
        const Summary on_cpu = repeated(std::max(1, frames / 20), [&] { find(); });
        const auto launched = launch();
        const auto& found = launched.wait();
        const std::string wrong = difference(found, find());
        table.row({name, what, std::to_string(here.triangles.rows), std::to_string(found.count),
                   number(by_events.median), range(by_events), number(clock.median), number(on_cpu.median),
                   number(first)});
        nlohmann::json row{{"step", name},
                           {"question", what},
                           {"triangles", here.triangles.rows},
                           {"rows", found.count},
                           {"device", to_json(by_events)},
                           {"device_and_wait", to_json(clock)},
                           {"cpu_all_threads", to_json(on_cpu)},
                           {"first_milliseconds", first}};
        set_right(row, name + ", " + what, wrong);
        add(std::move(row));
    };
    const ImpactQuery earliest{.output = Output::first};
    const ProximityQuery near{.radius = step.radius};
    const MeshView moving = there.view().moving_to(there.end()), moving_here = here.moving_to(end_here);
    measure("impacts", moving, moving_here, ImpactQuery());
    measure("first impact", moving, moving_here, earliest);
    measure("near", there.view(), here, near);
    measure("candidates", moving, moving_here, CandidateQuery());
}

void play_step(const std::string& name, const Options& options, int frames) {
    const Step step = load_step(name);
    const DeviceStep there(step);
    const MeshView moving = there.view().moving_to(there.end());
    const auto play = [&](const Scene& scene, const auto& query) {
        Detector detector(options);
        for (int i = 1; i < frames; ++i) detector.launch(scene, query).wait();
        check(cudaProfilerStart());
        detector.launch(scene, query).wait();
        check(cudaProfilerStop());
    };
    play(moving, ImpactQuery());
    play(there.view(), ProximityQuery{.radius = step.radius});
    play(moving, CandidateQuery());
}

}  // namespace crumple::benchmark
