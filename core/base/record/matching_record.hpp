// How the stiffness of a run was chosen: from which loads of which contacts (docs/theory/barriers.md, Matching).
#pragma once

#include <string>

#include "core/base/record/run_identity.hpp"

namespace bb {

struct MatchingRecord {
  BB_RECORD(MatchingRecord, "how stiffness was chosen (docs/theory/barriers.md, Matching)");
  BB_FIELD(std::string, rule, "matching rule") = "as_given";
  BB_FIELD(std::string, load_source, "of load_N", "given pilot static_weight none") = "none";
  BB_FIELD(std::string, limit_load_source, "of limit_load_N_per_m",
           "given pilot static_weight none") = "none";
  BB_FIELD(std::string, pilot_config_id, "config_id of the calibration run; empty: none", sha256_or_empty);
  BB_FIELD(
      std::string, pilot_note,
      "where the calibration run stopped early; which policies stay as given for want of a measured load");
  BB_FIELD(std::string, contact,
           "the calibration run's contact that needed the most stiffness; empty: none was compared");
  BB_FIELD(Number, contact_step, "step of the calibration run, from 0, at whose end it did");
  BB_FIELD(long long, contacts_considered,
           "contacts with a load, over all converged step ends of the calibration run") = 0;
  BB_FIELD(Number, contact_answer,
           "d log force/d log stiffness of `contact`: 0 where the world makes the force, 1 where kappa does");
  BB_FIELD(long long, contacts_left_out,
           "contacts whose force follows kappa, so that it is no load, over the same step ends") = 0;
  BB_FIELD(std::string, left_out_contact, "that with the largest force of them; empty: none");
  BB_FIELD(Number, left_out_N, "its force");
  BB_FIELD(std::string, limit_element,
           "the calibration run's limited element that needed the most; empty: none");
  BB_FIELD(Number, limit_step, "step of the calibration run at whose end it did");
  BB_FIELD(long long, elements_considered, "limited elements with a load, over the same step ends") = 0;
  BB_FIELD(Number, limit_answer, "as contact_answer, of `limit_element`");
  BB_FIELD(long long, elements_left_out, "limited elements whose force follows their stiffness") = 0;
  BB_FIELD(std::string, left_out_element, "that with the largest force of them; empty: none");
  BB_FIELD(Number, left_out_N_per_m, "its force over its width");
  BB_FIELD(Number, theta, "fraction of d_hat at which equal_force matches");
  BB_FIELD(Number, load_N, "of a pair; of a calibration run, the load of `contact`");
  BB_FIELD(Number, d_hat_m, "at which the load was matched: of `contact`, else the formulation's");
  BB_FIELD(Number, limit_load_N_per_m,
           "of the strain limit; of a calibration run, the load of `limit_element`");
  BB_FIELD(Number, curvature_N_per_m, "that equal_curvature matched");
  BB_FIELD(Number, limit_curvature, "the same of the strain limit");
  BB_FIELD(Number, kappa_N_per_m, "chosen; absent where the policy makes its own");
  BB_FIELD(Number, limit_stiffness_N_per_m, "k_s chosen");
  BB_FIELD(Number, solid_limit_load_Pa, "of the strain limit of solids, as given");
  BB_FIELD(Number, solid_limit_stiffness_Pa, "k_s chosen for solids");
  BB_FIELD(Number, scale, "factor on a contact policy that makes its own kappa; absent: as given");
  BB_FIELD(Number, limit_scale, "factor on a limit policy that makes its own kappa_e; absent: as given");
  BB_FIELD(Number, capacity_N, "largest load of the shape at that kappa; absent: unbounded");
  BB_RECORD_END;
};

}  // namespace bb
