#pragma once

// How any backend answers questions about features of worlds: the bodies of each world become one scene, whose vertices
// are posed at the start and at the end, and the backend searches it. A single body in place is searched where the
// caller has it.

#include <optional>

#include "base/cancellation.h"
#include "crumple/candidates.h"
#include "crumple/motion.h"
#include "crumple/near.h"
#include "engine/backend.h"
#include "engine/joined_lists.h"
#include "engine/near_input.h"
#include "engine/triangle_impacts.h"
#include "engine/world_scene.h"
#include "model/body_rules.h"
#include "model/rules.h"
#include "model/scene_features.h"
#include "model/world.h"

namespace crumple {

class FeatureSearch {
   public:
    FeatureSearch(MemoryMeter& meter, Cancellation& cancellation);

    /// `bodies`: whether the answer names bodies, else there is only one. `frugal`: see FeatureQuery.
    void find(BackendBase& backend, const World& world, const Motion& question, bool bodies, bool frugal,
              Impacts& answer);
    void find(BackendBase& backend, const World& world, const Near& question, bool bodies, bool frugal, Nearby& answer);
    void find(BackendBase& backend, const World& world, const CandidateQuestion& question, bool bodies, bool frugal,
              CandidateLists& answer);

    /// Gives all memory back.
    void release();

   private:
    template <class Question, class Answer>
    void search(BackendBase& backend, const World& world, const Question& question, Answer& answer);
    template <class Question, class Answer>
    void search_in_place(BackendBase& backend, const Question& question, Answer& answer);
    template <class Question, class Answer>
    void search_world(BackendBase& backend, std::int32_t pass, const Question& question, Answer& answer);
    void search_in_place(BackendBase& backend, const CandidateQuestion& question, CandidateLists& answer);
    void search_world(BackendBase& backend, std::int32_t pass, const CandidateQuestion& question,
                      CandidateLists& answer);

    /// Reads the world.
    void read(const World& world, const Rules& rules);
    /// Whether it is one body that is searched where the caller has it.
    bool in_place(const Rules& rules) const;
    /// Makes a scene of that body, or of the bodies of a pass, none if there are none; and prepares what it is searched
    /// with. `step`: from the start to the end, else at the start.
    Scene prepare_in_place(BackendBase& backend, bool step, bool weld);
    std::optional<Scene> prepare_pass(BackendBase& backend, std::int32_t pass, bool step, bool weld);
    /// How many bodies a pass has of its own.
    std::int32_t own_bodies(std::int32_t pass) const;
    template <class Question>
    void ask(BackendBase& backend, const Scene& scene, const Question& question);
    void ask_for_triangles(BackendBase& backend, const Scene& scene, const Motion& question);
    template <class Answer>
    void append_edges(std::size_t bodies, Answer& answer);
    template <class Answer>
    void append_points(std::size_t bodies, Answer& answer);
    template <class List>
    void append_rows(FeatureTypes types, const FeatureRows& rows, List& list);
    void add_first(std::int32_t pass, Impacts& answer) const;

    /// What an element of the scene is within its body.
    struct Place {
        std::int32_t body, index;
    };
    void place_features();
    Place point(std::int32_t p) const;
    Place edge(std::int32_t e) const;
    Place triangle(std::int32_t t) const;
    Place place(FeatureType type, std::int32_t i) const;
    void place(FeatureTypes types, const Pair& found, Pair& pair, BodyPair& bodies) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    bool bodies_ = false, frugal_ = false;  // of the call
    WorldOutline outline_;
    BodyRules rules_;
    GroupRule rule_;
    WorldScene scene_;
    JoinedLists lists_;
    SceneBuffers buffers_;
    SceneFeatures features_;
    NearInput near_input_;
    FeatureAnswer found_;
    TriangleImpacts triangle_impacts_;
    CandidateAnswer found_candidates_;
    // Of each body that was added to the scene; and how many there are:
    Array<std::int64_t> first_edge_, first_point_;
};

}  // namespace crumple
