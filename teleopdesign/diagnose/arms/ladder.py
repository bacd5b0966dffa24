def find_missing_in_arm(): pass
