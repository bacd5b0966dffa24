class ArmDiagnosis: pass
class ArmRung: pass
